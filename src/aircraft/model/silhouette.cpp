// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "aircraft/model/mesh.h"
#include "aircraft/model/texture.h"

namespace airtruth::aircraft {
namespace {

constexpr float kVisibleAlpha = 1.0f / 255.0f;
// The largest number of steps along a triangle's side, one per texel below it. Chosen: 256 steps
// and 7 bisections of a step resolve the side to 1/32768.
constexpr int kMaxSteps = 256;
constexpr int kBisections = 7;

using Barycentric = Eigen::Vector2f;

float turn(const Barycentric& o, const Barycentric& a, const Barycentric& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

bool left_of(const Barycentric& a, const Barycentric& b) {
  return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
}

// Corners of the convex hull (Andrew's monotone chain).
std::vector<Barycentric> hull_of(std::vector<Barycentric> points) {
  std::sort(points.begin(), points.end(), left_of);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Barycentric> hull;
  const auto add_chain = [&](auto begin, auto end) {
    const std::size_t first = hull.size();
    for (auto point = begin; point != end; ++point) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), *point) <= 0)
        hull.pop_back();
      hull.push_back(*point);
    }
    hull.pop_back();
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

// The visible part of a triangle whose texture has transparent texels. (s, t) stands for the point
// a + s (b - a) + t (c - a).
class Cutout {
 public:
  Cutout(const Mesh& mesh, const Triangle& triangle)
      : mesh_(mesh),
        material_(mesh.materials[triangle.material]),
        texture_(mesh.textures[static_cast<std::size_t>(material_.texture)]),
        vertex_(triangle.vertex) {
    float texels = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2f d = mesh.uvs[vertex_[(k + 1) % 3]] - mesh.uvs[vertex_[k]];
      texels = std::max(texels, std::abs(d.x()) * static_cast<float>(texture_.levels[0].width));
      texels = std::max(texels, std::abs(d.y()) * static_cast<float>(texture_.levels[0].height));
    }
    // The comparison is false for NaN, which then takes the largest number of steps.
    const bool few = texels < static_cast<float>(kMaxSteps);
    steps_ = few ? static_cast<int>(std::ceil(texels)) : kMaxSteps;
  }

  // The corners of the convex hull of the visible texels.
  std::vector<Eigen::Vector3f> corners() const {
    std::vector<Barycentric> ends = {{0, 0}, {1, 0}, {0, 1}};
    if (!std::all_of(ends.begin(), ends.end(), [&](const auto& at) { return visible(at); })) {
      ends.clear();
      scan_lines(ends);
    }
    std::vector<Eigen::Vector3f> result;
    for (const Barycentric& at : hull_of(std::move(ends))) result.push_back(position(at));
    return result;
  }

 private:
  void scan_lines(std::vector<Barycentric>& ends) const {
    const auto n = static_cast<float>(steps_);
    for (int k = 0; k <= steps_; ++k) {
      const float s = static_cast<float>(k) / n;
      scan({s, 0}, {s, 1 - s}, ends);
    }
    if (ends.empty()) return;
    for (int k = 0; k <= steps_; ++k) {
      const float t = static_cast<float>(k) / n;
      scan({0, t}, {1 - t, t}, ends);
    }
    scan({1, 0}, {0, 1}, ends);
  }

  // Appends the outermost visible points of a line.
  void scan(const Barycentric& from, const Barycentric& to, std::vector<Barycentric>& ends) const {
    const int first = first_visible(from, to);
    if (first > steps_) return;
    ends.push_back(border(from, to, first));
    ends.push_back(border(to, from, first_visible(to, from)));
  }

  Barycentric step(const Barycentric& from, const Barycentric& to, float k) const {
    return from + k / static_cast<float>(steps_) * (to - from);
  }

  int first_visible(const Barycentric& from, const Barycentric& to) const {
    int k = 0;
    while (k <= steps_ && !visible(step(from, to, static_cast<float>(k)))) ++k;
    return k;
  }

  // The border between an invisible step k - 1 and a visible step k, on the visible side.
  Barycentric border(const Barycentric& from, const Barycentric& to, int k) const {
    auto in = static_cast<float>(k);
    float out = k > 0 ? in - 1 : in;
    for (int i = 0; i < kBisections; ++i) {
      const float middle = 0.5f * (in + out);
      (visible(step(from, to, middle)) ? in : out) = middle;
    }
    return step(from, to, in);
  }

  bool visible(const Barycentric& at) const {
    const Eigen::Vector2f& a = mesh_.uvs[vertex_[0]];
    const Eigen::Vector2f uv =
        a + at.x() * (mesh_.uvs[vertex_[1]] - a) + at.y() * (mesh_.uvs[vertex_[2]] - a);
    return material_.opacity * alpha_at(texture_, uv.x(), uv.y()) >= kVisibleAlpha;
  }

  Eigen::Vector3f position(const Barycentric& at) const {
    const Eigen::Vector3f& a = mesh_.positions[vertex_[0]];
    return a + at.x() * (mesh_.positions[vertex_[1]] - a) +
           at.y() * (mesh_.positions[vertex_[2]] - a);
  }

  const Mesh& mesh_;
  const Material& material_;
  const Texture& texture_;
  std::array<std::uint32_t, 3> vertex_;
  int steps_ = 1;
};

bool has_cutouts(const Mesh& mesh, const Triangle& triangle) {
  const Material& material = mesh.materials[triangle.material];
  return material.texture >= 0 &&
         mesh.textures[static_cast<std::size_t>(material.texture)].has_translucency;
}

bool less(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

std::vector<Eigen::Vector3f> silhouette_of(const Mesh& mesh, const Part& part) {
  std::vector<bool> used(mesh.positions.size(), false);
  std::vector<Eigen::Vector3f> points;
  for (const Triangle& triangle : part.triangles) {
    if (mesh.materials[triangle.material].opacity < kVisibleAlpha) continue;
    if (has_cutouts(mesh, triangle)) {
      const std::vector<Eigen::Vector3f> corners = Cutout(mesh, triangle).corners();
      points.insert(points.end(), corners.begin(), corners.end());
      continue;
    }
    for (const std::uint32_t v : triangle.vertex) {
      if (!used[v]) points.push_back(mesh.positions[v]);
      used[v] = true;
    }
  }
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

}  // namespace

std::vector<std::vector<Eigen::Vector3f>> silhouette_points(const Mesh& mesh) {
  std::vector<std::vector<Eigen::Vector3f>> result;
  for (const Part& part : mesh.parts) result.push_back(silhouette_of(mesh, part));
  return result;
}

Extents extents(const Mesh& mesh) {
  Extents result;
  bool any = false;
  for (const auto& part : silhouette_points(mesh)) {
    for (const Eigen::Vector3f& point : part) {
      const Vector3 p = point.cast<double>();
      result.low_in_body = any ? Vector3(result.low_in_body.cwiseMin(p)) : p;
      result.high_in_body = any ? Vector3(result.high_in_body.cwiseMax(p)) : p;
      any = true;
    }
  }
  return result;
}

}  // namespace airtruth::aircraft
