// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "picture/render/ray_grid.h"
#include "picture/render/samples.h"

// The inner loops of silhouette.h: which samples of a pixel lie on the inner side of all sides of a
// triangle that cross it. An answer is -1 in `covered`; marking returns whether every sample is
// covered by now.
namespace airtruth::render {

// Where a pixel's samples are, and when: 0 to 1.
struct Places {
  alignas(32) std::array<float, PixelSamples::kMost> x;
  alignas(32) std::array<float, PixelSamples::kMost> y;
  alignas(32) std::array<float, PixelSamples::kMost> t;
};

// The value of a side's product over a pixel: a + b x + c y + d x y, in units of its largest
// corner.
struct Bilinear {
  float a = 1, b = 0, c = 0, d = 0;
};
Bilinear bilinear_of(const std::array<double, 4>& corner);

// A side's product over a pixel and its exposure: steady + u (first + u second), u from -1 to 1.
struct Swept {
  Bilinear steady, first, second;
};
// At the beginning, the middle and the end.
Swept swept_of(const Thrice<std::array<double, 4>>& corner);

// The first `crossing` of the sides cross the pixel, 1 to 3.
bool mark(const std::array<Bilinear, 3>& sides,
          int crossing,
          const Places& places,
          int samples,
          std::int32_t* covered);
bool mark(const std::array<Swept, 3>& sides,
          int crossing,
          const Places& places,
          int samples,
          std::int32_t* covered);

}  // namespace airtruth::render
