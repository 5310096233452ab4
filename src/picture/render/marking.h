// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "picture/render/ray_grid.h"
#include "picture/render/samples.h"

// The inner loops of silhouette.h: they mark the samples of a pixel that lie on the inner side of
// all sides of a triangle that cross the pixel. `covered` becomes -1 for such a sample. mark()
// returns true once every sample is covered.
namespace airtruth::render {

// Position of a pixel's samples (x, y) and their time in the exposure (t), each from 0 to 1.
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

// A side's product over a pixel and its exposure: steady + u (first + u second), with u from -1 to
// 1.
struct Swept {
  Bilinear steady, first, second;
};
// `corner`: the products at the beginning, the middle and the end of the exposure.
Swept swept_of(const Thrice<std::array<double, 4>>& corner);

// The value of a straight side over a pixel and its exposure: a + b x + c y + d t.
struct Straight {
  float a = 1, b = 0, c = 0, d = 0;
};
// All strips of a pixel (samples.h), as bits.
inline constexpr unsigned kAllStrips = (1U << PixelSamples::kStrips) - 1;
// Marks the samples of some strips, which are the bits of `strips`. `covered` and `places` are in
// the order of PixelSamples::fill(). `crossing`: how many of the sides cross the pixel, 1 to 3;
// they come first in `sides`. Returns the bits of those strips in which every sample is then
// covered.
unsigned mark(const std::array<Straight, 3>& sides,
              int crossing,
              bool moves,
              const Places& places,
              int samples,
              unsigned strips,
              std::int32_t* covered);

// `crossing`: as above.
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
