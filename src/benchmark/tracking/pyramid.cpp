// SPDX-License-Identifier: Apache-2.0
#include "benchmark/tracking/pyramid.h"

#include <algorithm>

#include "foundation/base/error.h"

namespace airtruth::tracking {

Pyramid::Pyramid(const image::Plane& luma, const PixelBox& part, int levels) {
  const auto inside = intersection(part, {0, 0, luma.width, luma.height});
  check(inside.has_value(), "a pyramid's part lies in the picture");
  left_ = inside->x;
  top_ = inside->y;
  std::vector<std::uint32_t> grey(static_cast<std::size_t>(inside->width) *
                                  static_cast<std::size_t>(inside->height));
  int width = inside->width;
  int height = inside->height;
  for (int y = 0; y < height; ++y)
    std::copy_n(
        luma.row(top_ + y) + left_, width, grey.begin() + static_cast<std::ptrdiff_t>(y) * width);
  for (int level = 0; level < levels; ++level) {
    if (level > 0) {
      // Sums of four: the level's power of four is left in.
      const int half_width = width / 2;
      const int half_height = height / 2;
      std::vector<std::uint32_t> half(static_cast<std::size_t>(half_width) *
                                      static_cast<std::size_t>(half_height));
      for (int y = 0; y < half_height; ++y)
        for (int x = 0; x < half_width; ++x) {
          const std::uint32_t* p = grey.data() + static_cast<std::ptrdiff_t>(2 * y) * width + 2 * x;
          half[static_cast<std::size_t>(y) * static_cast<std::size_t>(half_width) +
               static_cast<std::size_t>(x)] = p[0] + p[1] + p[width] + p[width + 1];
        }
      grey = std::move(half);
      width = half_width;
      height = half_height;
    }
    Level result{width, height, width + 1, {}};
    result.sums.assign(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 1),
                       0);
    for (int y = 0; y < height; ++y) {
      std::uint32_t row = 0;
      const std::uint32_t* above =
          result.sums.data() + static_cast<std::ptrdiff_t>(y) * result.stride;
      std::uint32_t* here = result.sums.data() + static_cast<std::ptrdiff_t>(y + 1) * result.stride;
      const std::uint32_t* source = grey.data() + static_cast<std::ptrdiff_t>(y) * width;
      for (int x = 0; x < width; ++x) {
        row += source[x];
        here[x + 1] = above[x + 1] + row;
      }
    }
    levels_.push_back(std::move(result));
  }
}

}  // namespace airtruth::tracking
