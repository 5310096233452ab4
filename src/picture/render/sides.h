// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "picture/render/straight.h"

// What triangles at an instant (straight.cpp) and in one row (row_triangle.cpp) have in common.
namespace airtruth::render {

// The strips between two places in the pixel.
inline unsigned strips_between(double low, double high) {
  // Covers the rounding of the samples' places.
  constexpr double kMargin = 1e-5;
  const auto strip = [](double x) {
    return std::clamp(
        static_cast<int>(std::floor(x * PixelSamples::kStrips)), 0, PixelSamples::kStrips - 1);
  };
  const unsigned up_to = (2U << strip(std::clamp(high + kMargin, 0.0, 1.0))) - 1;
  return up_to & ~((1U << strip(std::clamp(low - kMargin, 0.0, 1.0))) - 1);
}

inline double across(const Pixel& a, const Pixel& b) { return a.x() * b.y() - a.y() * b.x(); }

// Perpendicular to a side, towards the inside of a triangle whose corners are in the order of a
// positive area.
inline Pixel inward_of(const Pixel& from, const Pixel& to) {
  return {from.y() - to.y(), to.x() - from.x()};
}

// Adds a side that crosses the pixel. Returns false where the whole pixel is outside.
inline bool add_side(const Straight& side, PixelSides& sides) {
  const float low = std::min(0.0f, side.b) + std::min(0.0f, side.c) + std::min(0.0f, side.d);
  const float high = std::max(0.0f, side.b) + std::max(0.0f, side.c) + std::max(0.0f, side.d);
  sides.is_outside = side.a + high < 0;
  if (sides.is_outside) return false;
  if (side.a + low < 0) sides.side[static_cast<std::size_t>(sides.crossing++)] = side;
  return true;
}

}  // namespace airtruth::render
