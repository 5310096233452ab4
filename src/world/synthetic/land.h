// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "world/synthetic/noise.h"

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
  explicit Land(std::uint32_t seed);
  Place at(float north_m, float east_m) const;

 private:
  static constexpr int kBlocks = 8;  // along each side of the land
  struct Centre {
    std::uint32_t id = 0;
    float north = 0;  // in blocks, from the corner of its cell
    float east = 0;
    float cosine = 1;  // of the direction of its strips
    float sine = 0;
    float width_m = 0;
    float length_m = 0;
  };
  struct Block {
    const Centre* centre = nullptr;
    float north_m = 0;  // from the centre
    float east_m = 0;
    float edge_m = 0;
    std::uint32_t border = 0;  // the same seen from both sides
  };
  // Slow variation, read from a coarse map: bend of the borders (two), woods, height.
  Light slow(float north_m, float east_m) const;
  Block block(float north_m, float east_m, const Light& slow) const;
  Light crop(const Block& block, float north_m, float east_m) const;

  std::array<Centre, std::size_t{kBlocks} * kBlocks> centres_;
  std::vector<Light> slow_;
  std::vector<std::array<float, 2>> soil_;  // coarse and fine mottling
};

}  // namespace airtruth::synthetic
