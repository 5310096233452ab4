// SPDX-License-Identifier: Apache-2.0
#include "runners/tracking/pyramid.h"

#include <algorithm>

#include "foundation/base/error.h"

namespace airtruth::tracking {
namespace {

// A grey picture; a level's power of four is left in its values.
struct Grey {
  int width = 0, height = 0;
  std::vector<std::uint32_t> values;

  Grey(int w, int h)
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  std::uint32_t* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  const std::uint32_t* row(int y) const {
    return values.data() + static_cast<std::ptrdiff_t>(y) * width;
  }
};

// Sums of four.
Grey halved(const Grey& grey) {
  Grey half(grey.width / 2, grey.height / 2);
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x) {
      const std::uint32_t* p = grey.row(2 * y) + 2 * x;
      half.row(y)[x] = p[0] + p[1] + p[grey.width] + p[grey.width + 1];
    }
  return half;
}

// The integral picture: entry (x, y) is the sum over all values above and to the left.
std::vector<std::uint32_t> sums_of(const Grey& grey) {
  const int stride = grey.width + 1;
  std::vector<std::uint32_t> sums(
      static_cast<std::size_t>(stride) * static_cast<std::size_t>(grey.height + 1), 0);
  for (int y = 0; y < grey.height; ++y) {
    std::uint32_t row = 0;
    const std::uint32_t* above = sums.data() + static_cast<std::ptrdiff_t>(y) * stride;
    std::uint32_t* here = sums.data() + static_cast<std::ptrdiff_t>(y + 1) * stride;
    const std::uint32_t* source = grey.row(y);
    for (int x = 0; x < grey.width; ++x) {
      row += source[x];
      here[x + 1] = above[x + 1] + row;
    }
  }
  return sums;
}

}  // namespace

Pyramid::Pyramid(const image::Plane& luma, const PixelBox& part, int levels) {
  const auto inside = intersection(part, {0, 0, luma.width, luma.height});
  check(inside.has_value(), "a pyramid's part lies in the picture");
  left_ = inside->x;
  top_ = inside->y;
  Grey grey(inside->width, inside->height);
  for (int y = 0; y < grey.height; ++y)
    std::copy_n(luma.row(top_ + y) + left_, grey.width, grey.row(y));
  for (int level = 0; level < levels; ++level) {
    if (level > 0) grey = halved(grey);
    levels_.push_back({grey.width, grey.height, grey.width + 1, sums_of(grey)});
  }
}

}  // namespace airtruth::tracking
