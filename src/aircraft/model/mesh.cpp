// SPDX-License-Identifier: Apache-2.0
#include "aircraft/model/mesh.h"

#include <algorithm>
#include <cmath>

#include "aircraft/model/texture.h"

namespace airtruth::model {
namespace {

// 0 below 0, 1 above 1, with a continuous slope.
double smooth_step(double x) {
  const double u = std::clamp(x, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// The strength of a stroke: 1 within a bout, 0 in a glide. It changes over one stroke.
double strength(const Beat& beat, double strokes) {
  if (!(beat.glide > 0)) return 1;
  const double bouts = strokes / kStrokesOfBout;
  const double at = (bouts - std::floor(bouts)) * kStrokesOfBout;
  const double end = (1 - beat.glide) * kStrokesOfBout;
  return smooth_step(at) * (1 - smooth_step(at - end + 1));
}

void turn_about(Eigen::Affine3f& pose,
                const Eigen::Vector3f& centre,
                const Eigen::Vector3f& axis,
                float angle_rad) {
  pose.translate(centre);
  pose.rotate(Eigen::AngleAxisf(angle_rad, axis.normalized()));
  pose.translate(-centre);
}

void swing(Eigen::Affine3f& pose, const Hinge& hinge, const Beat& beat, double time_s) {
  const double strokes = beat.strokes_per_s * time_s + beat.phase_strokes;
  const double wave = std::sin(2 * kPi * (strokes - double(hinge.lag_strokes)));
  const double angle_rad =
      double(hinge.rest_rad) + strength(beat, strokes) * wave * double(hinge.amplitude_rad);
  turn_about(pose, hinge.centre_in_body, hinge.axis_in_body, static_cast<float>(angle_rad));
}

}  // namespace

std::size_t Mesh::triangle_count() const {
  std::size_t count = 0;
  for (const Part& part : parts) count += part.triangles.size();
  return count;
}

Eigen::Affine3f body_from_part(const Part& part, double time_s) {
  Eigen::Affine3f result = Eigen::Affine3f::Identity();
  for (const Hinge& hinge : part.hinges) swing(result, hinge, part.beat, time_s);
  if (!part.spins) return result;
  const double turns = part.revolutions_per_s * time_s;
  const auto angle = static_cast<float>(2 * kPi * (turns - std::floor(turns)));
  turn_about(result, part.centre_in_body, part.axis_in_body, angle);
  return result;
}

float reach_m(const Mesh& mesh, const Part& part) {
  // A point keeps its distance from the last hinge, and each hinge its distance from the one
  // before.
  Eigen::Vector3f from = part.centre_in_body;
  float of_hinges_m = 0;
  for (const Hinge& hinge : part.hinges) {
    of_hinges_m += (hinge.centre_in_body - from).norm();
    from = hinge.centre_in_body;
  }
  float of_points_m = 0;
  for (const Triangle& triangle : part.triangles)
    for (const std::uint32_t v : triangle.vertex)
      of_points_m = std::max(of_points_m, (mesh.positions[v] - from).norm());
  return of_hinges_m + of_points_m;
}

double fastest_turn_per_s(const Part& part) {
  double turns_per_s = part.spins ? std::abs(part.revolutions_per_s) : 0;
  // The slope of smooth_step is 1.5 at most, beside that of the wave, 2 pi.
  constexpr double kSteepest = 2 * kPi + 2 * 1.5;
  for (const Hinge& hinge : part.hinges)
    turns_per_s += kSteepest / (2 * kPi) * std::abs(part.beat.strokes_per_s) *
                   std::abs(double(hinge.amplitude_rad));
  return turns_per_s;
}

namespace {

// One code value of 255: what is fainter counts as invisible.
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
        texture_(*mesh.texture_of(material_)),
        vertex_(triangle.vertex) {
    float texels = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2f d = mesh.uvs[vertex_[(k + 1) % 3]] - mesh.uvs[vertex_[k]];
      texels = std::max(texels, std::abs(d.x()) * static_cast<float>(texture_.finest.width));
      texels = std::max(texels, std::abs(d.y()) * static_cast<float>(texture_.finest.height));
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

bool less(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

std::vector<Eigen::Vector3f> silhouette_of(const Mesh& mesh, const Part& part) {
  std::vector<bool> used(mesh.positions.size(), false);
  std::vector<Eigen::Vector3f> points;
  for (const Triangle& triangle : part.triangles) {
    const Material& material = mesh.materials[triangle.material];
    if (material.opacity < kVisibleAlpha) continue;
    if (mesh.has_translucent_texels(material)) {
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
  Eigen::AlignedBox3f bounds;
  for (const auto& part : silhouette_points(mesh))
    for (const Eigen::Vector3f& point : part) bounds.extend(point);
  if (bounds.isEmpty()) return {};
  return {bounds.min().cast<double>(), bounds.max().cast<double>()};
}

namespace {

// In English, and in the other languages that models of the catalogue use; blanks around each word.
constexpr std::string_view kGlassWords =
    " glass plexiglass plexiglas perspex window windows windshield windscreen canopy cristal verre "
    "vitre vitres ";
constexpr std::string_view kMetalWords =
    " metal chrome cromo aluminium aluminum steel titanium titanio mirror ";

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

}  // namespace

Finish finish_named(std::string_view material) {
  Finish finish = Finish::kPaint;
  std::string word = " ";
  for (std::size_t i = 0; i <= material.size(); ++i) {
    if (i < material.size() && is_letter(material[i])) {
      word += static_cast<char>(material[i] | 0x20);  // a small letter
      continue;
    }
    if (word.size() > 1) {
      word += ' ';
      if (kGlassWords.find(word) != std::string_view::npos) return Finish::kGlass;
      if (kMetalWords.find(word) != std::string_view::npos) finish = Finish::kMetal;
    }
    word.resize(1);
  }
  return finish;
}

}  // namespace airtruth::model
