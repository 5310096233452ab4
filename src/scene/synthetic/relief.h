// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "scene/synthetic/mip_map.h"
#include "scene/synthetic/rays.h"

namespace airtruth::synthetic {

// Place of the camera.
struct Eye {
  float north_m = 0;
  float east_m = 0;
  float height_m = 0;
};

// The heights of the ground's tile, for the search of rays.
struct HeightField {
  const MipMap* map = nullptr;
  float texel_m = 0;
  // Height of a height byte of 255.
  float highest_m = 0;
};

// Rays that may meet a tree or a house before they reach the ground.
struct Search {
  int count = 0;
  // Place of the ray in its batch.
  alignas(64) Integers ray;
  alignas(64) Floats north;
  alignas(64) Floats east;
  alignas(64) Floats down;
  // Distance to the level ground.
  alignas(64) Floats far_m;
  // Greatest height around.
  alignas(64) Floats peak_m;
  // Base-2 logarithm of the pixel's width in texels.
  alignas(64) Floats across;

  // Results of meet(). The nearest point of the ray that is inside a tree or a house; negative
  // where the ray meets none. And the factor of the shade there.
  alignas(64) Floats distance_m;
  alignas(64) Floats shade;
};

// Copies the numbers of the chosen places to the front.
template <typename Number>
[[gnu::always_inline]] inline void select(const Number* from,
                                          const std::int32_t* chosen,
                                          int count,
                                          Number* __restrict to) {
  for (int i = 0; i < count; ++i) to[i] = from[chosen[i]];
}

// Traces rays through the height field in a few equal steps, and bisects the step on which they
// meet it (relief mapping; Policarpo, Oliveira and Comba 2005).
void meet(const HeightField& field, const Eye& eye, Search& search);

}  // namespace airtruth::synthetic
