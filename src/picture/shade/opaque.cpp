// SPDX-License-Identifier: Apache-2.0
#include "picture/shade/opaque.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "aircraft/model/texture.h"

namespace airtruth::shade {
namespace {

// A triangle in a texture, in texels: the middle of texel (i, j) is (i, j).
using TexelCorners = std::array<Eigen::Vector2f, 3>;

// Where a horizontal line crosses a triangle: from `left` to `right`; none where left > right.
struct Crossing {
  float left = INFINITY;
  float right = -INFINITY;
};
Crossing crossing_of(const TexelCorners& corners, float y) {
  Crossing crossing;
  const auto add = [&](float x) {
    crossing.left = std::min(crossing.left, x);
    crossing.right = std::max(crossing.right, x);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector2f& a = corners[k];
    const Eigen::Vector2f& b = corners[(k + 1) % 3];
    if (a.y() == y) add(a.x());
    if ((a.y() < y) != (b.y() < y)) add(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  return crossing;
}

// The first texel at or after a place, and the one after the last at or before it.
int first_texel(float place, int size) {
  return static_cast<int>(std::clamp(std::ceil(place), 0.0F, static_cast<float>(size)));
}
int end_texel(float place, int size) {
  return static_cast<int>(std::clamp(std::floor(place) + 1, 0.0F, static_cast<float>(size)));
}

// A triangle in a texture; empty where the texture wraps round within it, or the coordinates are
// not finite.
std::optional<TexelCorners> corners_in(const model::Texture& texture,
                                       const std::array<Eigen::Vector2f, 3>& uvs) {
  Eigen::Vector2f low = uvs[0].cwiseMin(uvs[1]).cwiseMin(uvs[2]);
  Eigen::Vector2f high = uvs[0].cwiseMax(uvs[1]).cwiseMax(uvs[2]);
  if (!low.allFinite() || !high.allFinite()) return std::nullopt;
  const Eigen::Vector2f turns(texture.repeat_u ? std::floor(low.x()) : 0,
                              texture.repeat_v ? std::floor(low.y()) : 0);
  low -= turns;
  high -= turns;
  if (!(low.minCoeff() >= 0 && high.maxCoeff() <= 1)) return std::nullopt;
  const texture_file::Picture& finest = texture.finest;
  TexelCorners corners;
  for (std::size_t k = 0; k < 3; ++k)
    corners[k] = {(uvs[k].x() - turns.x()) * static_cast<float>(finest.width) - 0.5F,
                  (uvs[k].y() - turns.y()) * static_cast<float>(finest.height) - 0.5F};
  return corners;
}

// Calls use(y, from, to) for the texels [from, to) of row y within a triangle, or where it contains
// none, for the texel in its middle.
template <typename Use>
void each_run(const texture_file::Picture& finest, const TexelCorners& corners, const Use& use) {
  const auto [low, high] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
  bool has_texel = false;
  for (int y = first_texel(low, finest.height); y < end_texel(high, finest.height); ++y) {
    const Crossing crossing = crossing_of(corners, static_cast<float>(y));
    if (!(crossing.left <= crossing.right)) continue;
    const int from = first_texel(crossing.left, finest.width);
    const int to = end_texel(crossing.right, finest.width);
    if (from >= to) continue;
    has_texel = true;
    use(y, from, to);
  }
  if (has_texel) return;
  const Eigen::Vector2f middle = (corners[0] + corners[1] + corners[2]) / 3;
  const int x = std::clamp(static_cast<int>(std::lround(middle.x())), 0, finest.width - 1);
  const int y = std::clamp(static_cast<int>(std::lround(middle.y())), 0, finest.height - 1);
  use(y, x, x + 1);
}

// The least and the largest alpha of the texels within a triangle; of all alphas where the texture
// wraps round within it.
std::array<float, 2> alphas_within(const model::Texture& texture,
                                   const std::array<Eigen::Vector2f, 3>& uvs) {
  const auto corners = corners_in(texture, uvs);
  if (!corners) return {0, 1};
  float least = 1;
  float most = 0;
  each_run(texture.finest, *corners, [&](int y, int from, int to) {
    for (int x = from; x < to; ++x) {
      const float alpha = model::kDecoding.alpha[model::finest_bytes(texture, x, y)[3]];
      least = std::min(least, alpha);
      most = std::max(most, alpha);
    }
  });
  return {least, most};
}

Opacity opacity_of(const model::Mesh& mesh, const model::Triangle& triangle) {
  // Opacities, from 0 to 1, that differ by less are the same.
  constexpr float kEven = 0.01F;
  const model::Material& material = mesh.materials[triangle.material];
  const auto& [a, b, c] = triangle.vertex;
  if (!mesh.has_translucent_texels(material))
    return material.opacity >= model::kOpaque ? Opacity::kOpaque : Opacity::kEven;
  const auto [least, most] =
      alphas_within(*mesh.texture_of(material), {mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]});
  if (material.opacity >= model::kOpaque && least >= model::kOpaque) return Opacity::kOpaque;
  return material.opacity * (most - least) < kEven ? Opacity::kEven : Opacity::kVaries;
}

}  // namespace

std::vector<std::vector<Opacity>> opacities(const model::Mesh& mesh) {
  std::vector<std::vector<Opacity>> result;
  for (const model::Part& part : mesh.parts) {
    std::vector<Opacity>& of_part = result.emplace_back();
    for (const model::Triangle& triangle : part.triangles)
      of_part.push_back(opacity_of(mesh, triangle));
  }
  return result;
}

}  // namespace airtruth::shade
