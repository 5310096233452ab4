// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/synthetic/noise.h"

namespace airtruth::synthetic {

// The land cover of the ground: dry farmland in strips, tracks and roads between blocks of it,
// woods, and a river. It repeats every kLand_m metres along north and east.
constexpr float kLand_m = 5120;

// Number of places whose cover is found together.
constexpr int kBatch = 128;

// Places on the land and what covers it there. One array for each quantity, so that the compiler
// emits loops over vectors.
struct Places {
  using Floats = float[kBatch];
  using Integers = std::int32_t[kBatch];
  int count = 0;
  alignas(64) Floats north_m, east_m;
  // Linear light of the bare ground, without trees, shadows and houses.
  alignas(64) Floats red, green, blue;
  // Share of the ground under trees, 0..1.
  alignas(64) Floats wood;
  // Distance from the nearest track or road, and 1 where trees stand along it, else 0.
  alignas(64) Floats track_m;
  alignas(64) Integers hedge;
  // Distance from the river's middle.
  alignas(64) Floats river_m;
  // 1 on fields, else 0.
  alignas(64) Integers field;
};

class Land {
 public:
  explicit Land(std::uint32_t seed);
  // Fills in the cover of `count` places.
  void cover(Places& places) const;

 private:
  // Number of blocks along each side of the land.
  static constexpr int kBlocks = 8;
  static constexpr std::size_t kCentres = std::size_t{kBlocks} * kBlocks;
  // Blocks of fields, each with the direction and size of its strips.
  struct Centres {
    std::array<std::uint32_t, kCentres> id;
    // In blocks, from the corner of the centre's cell.
    std::array<float, kCentres> north;
    std::array<float, kCentres> east;
    // Cosine and sine of the direction of its strips.
    std::array<float, kCentres> cosine;
    std::array<float, kCentres> sine;
    std::array<float, kCentres> width_m;
    std::array<float, kCentres> length_m;
  };
  // The block of each place and the nearest block beside, and the position relative to its centre.
  struct Blocks {
    alignas(64) Places::Integers block, neighbour;
    alignas(64) Places::Floats north_m, east_m;
  };
  void find_blocks(Places& places, Blocks& blocks) const;
  void sow(const Blocks& blocks, Places& places) const;
  void cross(const Blocks& blocks, Places& places) const;

  Centres centres_;
  std::vector<LinearRgb> slow_;
  // Coarse and fine mottling.
  std::vector<float> coarse_soil_;
  std::vector<float> fine_soil_;
};

}  // namespace airtruth::synthetic
