// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "scene/synthetic/noise.h"

namespace airtruth::synthetic {

// The land repeats after this distance along north and along east.
constexpr float kLand_m = 5120;

// What covers a place of the land.
struct Cover {
  // Linear light of the bare ground, without trees, shadows and houses.
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

// The land cover of the ground: dry farmland in strips, tracks and roads between blocks of it,
// woods, and a river.
class Land {
 public:
  explicit Land(std::uint32_t seed);
  Cover at(float north_m, float east_m) const;

 private:
  // A block of fields: the cell of a jittered grid (Worley 1996) with its own direction and size of
  // strips.
  struct Block {
    std::uint32_t id = 0;
    // Place of its centre in its cell, in blocks.
    float north = 0;
    float east = 0;
    // Direction of its strips.
    float cosine = 1;
    float sine = 0;
    float width_m = 0;
    float length_m = 0;
  };
  // The blocks whose centres are nearest to a place.
  struct Nearest {
    const Block* block = nullptr;
    const Block* neighbour = nullptr;
    // The place relative to the nearest centre, and the distances to both, in blocks.
    float north = 0;
    float east = 0;
    float square = 1e9F;
    float second_square = 1e9F;
  };
  Nearest nearest(float north, float east) const;
  LinearRgb parcel(float north_m, float east_m, const Nearest& nearest) const;

  Tile<Block> blocks_;
  // Slowly varying: the bend of the borders (two), woods, height.
  Tile<LinearRgb> slow_;
  // Coarse and fine mottling of the soil.
  Tile<float> coarse_soil_;
  Tile<float> fine_soil_;
};

}  // namespace airtruth::synthetic
