// SPDX-License-Identifier: Apache-2.0
#include "picture/render/opaque.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

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

// Counts a texture's translucent texels in any rectangle (a summed-area table: Crow 1984).
class TranslucentTexels {
 public:
  explicit TranslucentTexels(const aircraft::Texture& texture)
      : texture_(texture),
        width_(texture.levels.front().width),
        height_(texture.levels.front().height) {
    sums_.assign(static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1), 0);
    for (int y = 0; y < height_; ++y) {
      std::uint32_t row = 0;
      for (int x = 0; x < width_; ++x) {
        row += texture.levels.front()
                   .texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(x)][3] < aircraft::kOpaque;
        sums_[at(x + 1, y + 1)] = sums_[at(x + 1, y)] + row;
      }
    }
  }

  // True where a texel within the triangle is translucent. Where the texture wraps round within
  // it, all texels count.
  bool any(const std::array<Eigen::Vector2f, 3>& uvs) const {
    Eigen::Vector2f low = uvs[0].cwiseMin(uvs[1]).cwiseMin(uvs[2]);
    Eigen::Vector2f high = uvs[0].cwiseMax(uvs[1]).cwiseMax(uvs[2]);
    if (!low.allFinite() || !high.allFinite()) return true;
    const Eigen::Vector2f turns(texture_.repeat_u ? std::floor(low.x()) : 0,
                                texture_.repeat_v ? std::floor(low.y()) : 0);
    low -= turns;
    high -= turns;
    if (!(low.minCoeff() >= 0 && high.maxCoeff() <= 1)) return sums_.back() > 0;
    TexelCorners corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = {(uvs[k].x() - turns.x()) * static_cast<float>(width_) - 0.5F,
                    (uvs[k].y() - turns.y()) * static_cast<float>(height_) - 0.5F};
    return any_within(corners);
  }

 private:
  bool any_within(const TexelCorners& corners) const {
    const auto [low, high] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
    bool has_texel = false;
    for (int y = first(low, height_); y < end(high, height_); ++y) {
      const Crossing crossing = crossing_of(corners, static_cast<float>(y));
      if (!(crossing.left <= crossing.right)) continue;
      const int from = first(crossing.left, width_);
      const int to = end(crossing.right, width_);
      if (from >= to) continue;
      has_texel = true;
      if (count(from, y, to, y + 1) > 0) return true;
    }
    if (has_texel) return false;
    const Eigen::Vector2f middle = (corners[0] + corners[1] + corners[2]) / 3;
    const int x = std::clamp(static_cast<int>(std::lround(middle.x())), 0, width_ - 1);
    const int y = std::clamp(static_cast<int>(std::lround(middle.y())), 0, height_ - 1);
    return count(x, y, x + 1, y + 1) > 0;
  }

  // The first texel at or after a place, and the one after the last at or before it.
  static int first(float place, int size) {
    return static_cast<int>(std::clamp(std::ceil(place), 0.0F, static_cast<float>(size)));
  }
  static int end(float place, int size) {
    return static_cast<int>(std::clamp(std::floor(place) + 1, 0.0F, static_cast<float>(size)));
  }

  std::uint32_t count(int left, int bottom, int right, int top) const {
    return sums_[at(right, top)] - sums_[at(left, top)] - sums_[at(right, bottom)] +
           sums_[at(left, bottom)];
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) +
           static_cast<std::size_t>(x);
  }
  const aircraft::Texture& texture_;
  int width_;
  int height_;
  std::vector<std::uint32_t> sums_;
};

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

}  // namespace airtruth::render
