// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "world/synthetic/noise.h"

namespace airtruth::synthetic {

// The land cover of the ground: dry farmland in strips, tracks and roads between blocks of it,
// woods, and a river. It repeats every kLand_m metres along north and east.
constexpr float kLand_m = 5120;

struct Place {
  // Of the bare ground, without trees, shadows and houses.
  LinearRgb albedo = LinearRgb::Zero();
  // Share of the ground under trees, 0..1.
  float wood = 0;
  // Distance from the nearest track or road.
  float track_m = 0;
  // True where trees stand along that track.
  bool hedge = false;
  // Distance from the river's middle.
  float river_m = 0;
  bool field = false;
};

class Land {
 public:
  explicit Land(std::uint32_t seed);
  Place at(float north_m, float east_m) const;

 private:
  // Number of blocks along each side of the land.
  static constexpr int kBlocks = 8;
  struct Centre {
    std::uint32_t id = 0;
    // In blocks, from the corner of the centre's cell.
    float north = 0;
    float east = 0;
    // Cosine and sine of the direction of its strips.
    float cosine = 1;
    float sine = 0;
    float width_m = 0;
    float length_m = 0;
  };
  struct Block {
    const Centre* centre = nullptr;
    // Position relative to the centre.
    float north_m = 0;
    float east_m = 0;
    float edge_m = 0;
    // Identifier of the border, the same on both sides.
    std::uint32_t border = 0;
  };
  // Slowly varying fields, from a coarse map: the bend of the borders (two), woods, height.
  LinearRgb slow(float north_m, float east_m) const;
  Block block(float north_m, float east_m, const LinearRgb& slow) const;
  LinearRgb crop(const Block& block, float north_m, float east_m) const;

  std::array<Centre, std::size_t{kBlocks} * kBlocks> centres_;
  std::vector<LinearRgb> slow_;
  // Coarse and fine mottling.
  std::vector<std::array<float, 2>> soil_;
};

}  // namespace airtruth::synthetic
