// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace airtruth::synthetic {

// The light that reaches each pixel of a row through the lens: linear red, green and blue before
// the lens's fall-off, and that fall-off, 0 to 1. The arrays have room for `width` rounded up to a
// multiple of 8.
struct LightRow {
  explicit LightRow(int width)
      : red((static_cast<std::size_t>(width) + 7) & ~std::size_t{7}),
        green(red.size()),
        blue(red.size()),
        fall_off(red.size()) {}
  std::vector<float> red;
  std::vector<float> green;
  std::vector<float> blue;
  std::vector<float> fall_off;
};

// Directions of the rays of a row, north-east-down, with the same room.
struct RayRow {
  explicit RayRow(int width)
      : north((static_cast<std::size_t>(width) + 7) & ~std::size_t{7}),
        east(north.size()),
        down(north.size()) {}
  std::vector<float> north;
  std::vector<float> east;
  std::vector<float> down;
};

}  // namespace airtruth::synthetic
