// SPDX-License-Identifier: Apache-2.0
#include "aircraft/mesh.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "aircraft/texture.h"

namespace airtruth::aircraft {
namespace {

constexpr float kVisibleAlpha = 1.0f / 255.0f;

bool translucent(const Mesh& mesh, const Triangle& triangle) {
  const Material& material = mesh.materials[triangle.material];
  return material.texture >= 0 &&
         mesh.textures[static_cast<std::size_t>(material.texture)].has_translucency;
}

// Samples of a triangle whose texel can be seen and one of whose neighbours cannot, or that lie on
// its border.
void add_visible_border(const Mesh& mesh,
                        const Triangle& triangle,
                        std::vector<Eigen::Vector3f>& points) {
  const Texture& texture =
      mesh.textures[static_cast<std::size_t>(mesh.materials[triangle.material].texture)];
  const std::uint32_t a = triangle.vertex[0];
  const std::uint32_t b = triangle.vertex[1];
  const std::uint32_t c = triangle.vertex[2];
  const auto texels = [&](std::uint32_t i, std::uint32_t j) {
    const Eigen::Vector2f d = mesh.uvs[i] - mesh.uvs[j];
    return std::max(std::abs(d.x()) * static_cast<float>(texture.levels[0].width),
                    std::abs(d.y()) * static_cast<float>(texture.levels[0].height));
  };
  const float longest = std::max({texels(a, b), texels(b, c), texels(c, a)});
  const int n =
      std::isfinite(longest) ? std::clamp(static_cast<int>(std::ceil(longest)), 1, 96) : 96;
  const auto visible = [&](int i, int j) {
    if (i < 0 || j < 0 || i + j > n) return false;
    const float u = static_cast<float>(i) / static_cast<float>(n);
    const float v = static_cast<float>(j) / static_cast<float>(n);
    const Eigen::Vector2f uv =
        mesh.uvs[a] + u * (mesh.uvs[b] - mesh.uvs[a]) + v * (mesh.uvs[c] - mesh.uvs[a]);
    return alpha_at(texture, uv.x(), uv.y()) >= kVisibleAlpha;
  };
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      if (!visible(i, j)) continue;
      const bool inside =
          visible(i - 1, j) && visible(i + 1, j) && visible(i, j - 1) && visible(i, j + 1);
      if (inside) continue;
      const float u = static_cast<float>(i) / static_cast<float>(n);
      const float v = static_cast<float>(j) / static_cast<float>(n);
      points.push_back(mesh.positions[a] + u * (mesh.positions[b] - mesh.positions[a]) +
                       v * (mesh.positions[c] - mesh.positions[a]));
    }
  }
}

}  // namespace

std::size_t Mesh::triangle_count() const {
  std::size_t count = 0;
  for (const Part& part : parts) count += part.triangles.size();
  return count;
}

Eigen::Affine3f body_from_part(const Part& part, double time_s) {
  Eigen::Affine3f result = Eigen::Affine3f::Identity();
  if (!part.spins) return result;
  const double turns = part.revolutions_per_s * time_s;
  const auto angle = static_cast<float>(2 * kPi * (turns - std::floor(turns)));
  result.translate(part.centre_in_body);
  result.rotate(Eigen::AngleAxisf(angle, part.axis_in_body.normalized()));
  result.translate(-part.centre_in_body);
  return result;
}

std::vector<std::vector<Eigen::Vector3f>> silhouette_points(const Mesh& mesh) {
  std::vector<std::vector<Eigen::Vector3f>> result;
  for (const Part& part : mesh.parts) {
    std::set<std::uint32_t> vertices;
    std::vector<Eigen::Vector3f> points;
    for (const Triangle& triangle : part.triangles) {
      if (mesh.materials[triangle.material].opacity < kVisibleAlpha) continue;
      if (translucent(mesh, triangle)) {
        add_visible_border(mesh, triangle, points);
      } else {
        vertices.insert(triangle.vertex.begin(), triangle.vertex.end());
      }
    }
    const auto less = [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
      return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    };
    for (std::uint32_t v : vertices) points.push_back(mesh.positions[v]);
    std::sort(points.begin(), points.end(), less);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    result.push_back(std::move(points));
  }
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
