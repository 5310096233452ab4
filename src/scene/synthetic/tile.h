// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "foundation/geometry/transform.h"
#include "scene/synthetic/land.h"
#include "scene/synthetic/noise.h"

namespace airtruth::synthetic {

// The ground as a square tile of colour and height that repeats, with its mip levels (Williams
// 1983) one after the other in memory. A texel packs the square roots of red, green and blue, and
// the height, from the lowest byte to the highest. Squares of 4 x 4 texels are stored together, so
// that neighbours in any direction are mostly on the same line of the cache.
struct Tile {
  // Largest height of trees and houses, that of a height byte of 255.
  static constexpr float kHighest_m = 16;
  // Number of levels of a tile of 2^16 texels a side, down to two.
  static constexpr int kMaxLevels = 16;
  // Number of levels of peaks, and the side of the cells of the first; the last have 1,280 m.
  static constexpr int kPeakLevels = 8;
  static constexpr float kPeakCell_m = 10;

  // `wanted_m` is the side of a texel; it is rounded so that the tile's side is a power of two
  // texels.
  Tile(double wanted_m, const Vector3& sun_in_world, std::uint32_t seed);

  std::vector<std::uint32_t> texels;
  // Texels along a side of level 0, a power of two, and the side of one.
  int size = 0;
  float texel_m = 0;
  int levels = 0;
  // By level: the index of its first texel, its size minus one, and its size relative to level 0.
  std::array<std::int32_t, kMaxLevels> first{};
  std::array<std::int32_t, kMaxLevels> wrap{};
  std::array<float, kMaxLevels> scale{};
  // Greatest heights in and beside square cells, level after level; the cells of each level are
  // twice as wide as those of the level before. They let rays over open fields skip the search.
  std::vector<std::uint8_t> peaks;
  std::array<std::int32_t, kPeakLevels> first_peak{};

  // A texel of level 0.
  std::uint32_t& texel(int x, int y);

 private:
  void make_levels();
  void find_peaks();
};

// Index of a texel of a level is the sum of these two and of the index of the level's first texel.
inline std::int32_t index_of_row(std::int32_t y, std::int32_t wrap) {
  return (y & ~3) * (wrap + 1) + (y & 3) * 4;
}
inline std::int32_t index_in_row(std::int32_t x) { return (x & ~3) * 4 + (x & 3); }

inline std::uint32_t& Tile::texel(int x, int y) {
  return texels[static_cast<std::size_t>(index_of_row(y & wrap[0], wrap[0]) +
                                         index_in_row(x & wrap[0]))];
}

// The four texels around a place and the weights of the right and of the lower ones, 0 to 16.
struct Neighbours {
  std::int32_t upper_left, upper_right, lower_left, lower_right;
  std::uint32_t right, lower;
};

// `x` and `y` are in texels of the level, from the centre of its first texel.
inline Neighbours neighbours(float x, float y, std::int32_t first, std::int32_t wrap) {
  const std::int32_t ix = floor_int(x);
  const std::int32_t iy = floor_int(y);
  const std::int32_t upper = first + index_of_row(iy & wrap, wrap);
  const std::int32_t lower = first + index_of_row((iy + 1) & wrap, wrap);
  const std::int32_t left = index_in_row(ix & wrap);
  const std::int32_t right = index_in_row((ix + 1) & wrap);
  const auto sixteenths = [](float part) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(part * 16));
  };
  return {upper + left,
          upper + right,
          lower + left,
          lower + right,
          sixteenths(x - static_cast<float>(ix)),
          sixteenths(y - static_cast<float>(iy))};
}

// Weighted sum of a byte, or of two bytes 16 bits apart, of the four texels; 256 is the sum of the
// weights.
template <typename Part>
inline std::uint32_t weighted(const std::uint32_t* texels, const Neighbours& n, const Part& part) {
  return part(texels[n.upper_left]) * ((16 - n.right) * (16 - n.lower)) +
         part(texels[n.upper_right]) * (n.right * (16 - n.lower)) +
         part(texels[n.lower_left]) * ((16 - n.right) * n.lower) +
         part(texels[n.lower_right]) * (n.right * n.lower);
}

}  // namespace airtruth::synthetic
