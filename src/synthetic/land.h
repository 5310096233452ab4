// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "synthetic/noise.h"

namespace airtruth::synthetic {

// What lies at a place of the ground: dry farmland in strips, tracks and roads between blocks of
// it, woods, a river. Repeats every kLand_m along north and east.
constexpr float kLand_m = 5120;

struct Place {
  Light albedo = Light::Zero();  // bare: without trees, shadows and houses
  float wood = 0;                // share of the ground under trees, 0..1
  float track_m = 0;             // distance from the nearest track or road
  bool hedge = false;            // trees stand along that track
  float river_m = 0;             // distance from the river's middle
  bool field = false;
};

class Land {
 public:
  explicit Land(std::uint32_t seed) : seed_(seed) {}
  Place at(float north_m, float east_m) const;

 private:
  struct Block {
    std::uint32_t id = 0;
    float north = 0;  // from the block's centre
    float east = 0;
    float edge_m = 0;
    std::uint32_t border = 0;  // the same seen from both sides
  };
  Block block(float north_m, float east_m) const;
  Light crop(const Block& block, float north_m, float east_m) const;

  std::uint32_t seed_;
};

}  // namespace airtruth::synthetic
