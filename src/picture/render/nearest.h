// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "picture/render/marking.h"

// The depth buffer of a pixel: the nearest of its triangles at each of its samples (Catmull 1974).
namespace airtruth::render {

// The nearest triangle of each of a pixel's samples, in the order of PixelSamples::fill_cells().
struct Nearest {
  static constexpr std::size_t kMost = 256;
  // In the units of Seen::nearness; 0 where no triangle is.
  alignas(64) std::array<float, kMost> nearness;
  alignas(64) std::array<std::int32_t, kMost> triangle;
};
// The depth of a triangle over one pixel: a plane and its bounds.
struct PixelDepth {
  Straight nearness;
  float farthest = 0;
  float nearest = 0;
};
// Puts a triangle before those that are farther away, where it is inside its sides: in `strips` of
// the first `samples` places. The range of the strips must be without a gap.
void keep_nearest(const std::array<Straight, 3>& sides,
                  const PixelDepth& depth,
                  std::uint32_t triangle,
                  bool moves,
                  const Places& places,
                  int samples,
                  unsigned strips,
                  Nearest& nearest);
// The same for the samples where `inside` is not 0.
void keep_nearest(const std::int32_t* inside,
                  const PixelDepth& depth,
                  std::uint32_t triangle,
                  bool moves,
                  const Places& places,
                  int samples,
                  Nearest& nearest);

// The least nearness of the first `samples`: what is less near is hidden in all of them.
float least_nearness(const Nearest& nearest, int samples);

}  // namespace airtruth::render
