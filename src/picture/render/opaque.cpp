// SPDX-License-Identifier: Apache-2.0
#include "picture/render/opaque.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace airtruth::render {
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
std::optional<TexelCorners> corners_in(const aircraft::Texture& texture,
                                       const std::array<Eigen::Vector2f, 3>& uvs) {
  Eigen::Vector2f low = uvs[0].cwiseMin(uvs[1]).cwiseMin(uvs[2]);
  Eigen::Vector2f high = uvs[0].cwiseMax(uvs[1]).cwiseMax(uvs[2]);
  if (!low.allFinite() || !high.allFinite()) return std::nullopt;
  const Eigen::Vector2f turns(texture.repeat_u ? std::floor(low.x()) : 0,
                              texture.repeat_v ? std::floor(low.y()) : 0);
  low -= turns;
  high -= turns;
  if (!(low.minCoeff() >= 0 && high.maxCoeff() <= 1)) return std::nullopt;
  const aircraft::Texture::Level& level = texture.levels.front();
  TexelCorners corners;
  for (std::size_t k = 0; k < 3; ++k)
    corners[k] = {(uvs[k].x() - turns.x()) * static_cast<float>(level.width) - 0.5F,
                  (uvs[k].y() - turns.y()) * static_cast<float>(level.height) - 0.5F};
  return corners;
}

// Calls use(y, from, to) for the texels [from, to) of row y within a triangle, or where it contains
// none, for the texel in its middle, until `use` returns true. Returns whether it did.
template <typename Use>
bool any_run(const aircraft::Texture::Level& level, const TexelCorners& corners, const Use& use) {
  const auto [low, high] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
  bool has_texel = false;
  for (int y = first_texel(low, level.height); y < end_texel(high, level.height); ++y) {
    const Crossing crossing = crossing_of(corners, static_cast<float>(y));
    if (!(crossing.left <= crossing.right)) continue;
    const int from = first_texel(crossing.left, level.width);
    const int to = end_texel(crossing.right, level.width);
    if (from >= to) continue;
    has_texel = true;
    if (use(y, from, to)) return true;
  }
  if (has_texel) return false;
  const Eigen::Vector2f middle = (corners[0] + corners[1] + corners[2]) / 3;
  const int x = std::clamp(static_cast<int>(std::lround(middle.x())), 0, level.width - 1);
  const int y = std::clamp(static_cast<int>(std::lround(middle.y())), 0, level.height - 1);
  return use(y, x, x + 1);
}

float alpha_at(const aircraft::Texture::Level& level, int x, int y) {
  return level.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) +
                      static_cast<std::size_t>(x)][3];
}

// Counts a texture's translucent texels in any rectangle (a summed-area table: Crow 1984).
class TranslucentTexels {
 public:
  explicit TranslucentTexels(const aircraft::Texture& texture)
      : texture_(texture), level_(texture.levels.front()) {
    sums_.assign(
        static_cast<std::size_t>(level_.width + 1) * static_cast<std::size_t>(level_.height + 1),
        0);
    for (int y = 0; y < level_.height; ++y) {
      std::uint32_t row = 0;
      for (int x = 0; x < level_.width; ++x) {
        row += alpha_at(level_, x, y) < aircraft::kOpaque;
        sums_[at(x + 1, y + 1)] = sums_[at(x + 1, y)] + row;
      }
    }
  }

  // True where a texel within the triangle is translucent. Where the texture wraps round within
  // it, all texels count, and a texture with this table has translucent ones.
  bool any(const std::array<Eigen::Vector2f, 3>& uvs) const {
    const auto corners = corners_in(texture_, uvs);
    if (!corners) return true;
    return any_run(
        level_, *corners, [&](int y, int from, int to) { return count(from, y, to, y + 1) > 0; });
  }

 private:
  std::uint32_t count(int left, int bottom, int right, int top) const {
    return sums_[at(right, top)] - sums_[at(left, top)] - sums_[at(right, bottom)] +
           sums_[at(left, bottom)];
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(level_.width + 1) +
           static_cast<std::size_t>(x);
  }
  const aircraft::Texture& texture_;
  const aircraft::Texture::Level& level_;
  std::vector<std::uint32_t> sums_;
};

// True where the alphas of the texels within the triangle differ by less than kEven, each times the
// material's opacity.
bool is_even(const aircraft::Texture& texture,
             float opacity,
             const std::array<Eigen::Vector2f, 3>& uvs) {
  constexpr float kEven = 0.01F;
  const auto corners = corners_in(texture, uvs);
  if (!corners) return false;
  const aircraft::Texture::Level& level = texture.levels.front();
  float least = 1;
  float most = 0;
  return !any_run(level, *corners, [&](int y, int from, int to) {
    for (int x = from; x < to; ++x) {
      least = std::min(least, alpha_at(level, x, y));
      most = std::max(most, alpha_at(level, x, y));
    }
    return opacity * (most - least) >= kEven;
  });
}

}  // namespace

std::vector<std::vector<std::uint8_t>> opaque_triangles(const aircraft::Mesh& mesh) {
  std::vector<std::unique_ptr<TranslucentTexels>> tables;
  for (const aircraft::Texture& texture : mesh.textures)
    tables.push_back(texture.has_translucency ? std::make_unique<TranslucentTexels>(texture)
                                              : nullptr);
  std::vector<std::vector<std::uint8_t>> result;
  for (const aircraft::Part& part : mesh.parts) {
    std::vector<std::uint8_t>& flags = result.emplace_back();
    for (const aircraft::Triangle& triangle : part.triangles) {
      const aircraft::Material& material = mesh.materials[triangle.material];
      const auto& [a, b, c] = triangle.vertex;
      const TranslucentTexels* table =
          material.texture < 0 ? nullptr : tables[static_cast<std::size_t>(material.texture)].get();
      const bool holes = table != nullptr && table->any({mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]});
      flags.push_back(material.opacity >= aircraft::kOpaque && !holes ? 1 : 0);
    }
  }
  return result;
}

std::vector<std::vector<std::uint8_t>> even_triangles(
    const aircraft::Mesh& mesh, const std::vector<std::vector<std::uint8_t>>& opaque) {
  std::vector<std::vector<std::uint8_t>> even = opaque;
  for (std::size_t p = 0; p < even.size(); ++p)
    for (std::size_t t = 0; t < even[p].size(); ++t) {
      if (opaque[p][t] != 0) continue;
      const aircraft::Triangle& triangle = mesh.parts[p].triangles[t];
      const aircraft::Material& material = mesh.materials[triangle.material];
      const auto& [a, b, c] = triangle.vertex;
      const aircraft::Texture* texture =
          material.texture < 0 ? nullptr
                               : &mesh.textures[static_cast<std::size_t>(material.texture)];
      even[p][t] = texture == nullptr || !texture->has_translucency ||
                   is_even(*texture, material.opacity, {mesh.uvs[a], mesh.uvs[b], mesh.uvs[c]});
    }
  return even;
}

}  // namespace airtruth::render
