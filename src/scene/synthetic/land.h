// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/synthetic/noise.h"
#include "scene/synthetic/rays.h"

namespace airtruth::synthetic {

// The land cover of the ground: dry farmland in strips, tracks and roads between blocks of it,
// woods, and a river. It repeats every kLand_m metres along north and east.
constexpr float kLand_m = 5120;

// Places on the land and what covers it there.
struct Places {
  int count = 0;
  alignas(64) Floats north_m;
  alignas(64) Floats east_m;
  // Linear light of the bare ground, without trees, shadows and houses.
  Light albedo;
  // Share of the ground under trees, 0..1.
  alignas(64) Floats wood;
  // Distance from the nearest track or road.
  alignas(64) Floats track_m;
  // 1 where trees stand along that track, else 0.
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
  // What the steps of cover() hand on.
  struct Work {
    // Slowly varying fields, from a coarse map: the bend of the borders (two), woods, height.
    alignas(64) Floats bend_north;
    alignas(64) Floats bend_east;
    alignas(64) Floats woods;
    alignas(64) Floats height;
    // The nearest centre and the one after.
    alignas(64) Integers block;
    alignas(64) Integers neighbour;
    // Position relative to the centre.
    alignas(64) Floats north_m;
    alignas(64) Floats east_m;
    // Identifier of the border, the same on both sides.
    alignas(64) Integers border;
    // Random number of the parcel, and the position across its strip.
    alignas(64) Integers parcel;
    alignas(64) Floats across_m;
    alignas(64) Floats margin_m;
  };
  void read_slow_map(const Places& places, Work& work) const;
  void find_blocks(Places& places, Work& work) const;
  void find_borders(Places& places, Work& work) const;
  void find_parcels(const Places& places, Work& work) const;
  void sow(const Work& work, Places& places) const;

  Centres centres_;
  std::vector<LinearRgb> slow_;
  // Coarse and fine mottling.
  std::vector<float> coarse_soil_;
  std::vector<float> fine_soil_;
};

}  // namespace airtruth::synthetic
