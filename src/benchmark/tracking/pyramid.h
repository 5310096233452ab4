// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::tracking {

// Box sums of a part of a picture's luma at several resolutions, each half the one before (2x2
// means). The part is aligned so that pixel (x, y) of level p covers full pixels from (2^p x +
// left, 2^p y + top) on. Only the part is read: cost follows it, not the picture.
class Pyramid {
 public:
  // `part` is cut to the picture and grown to whole pixels of the coarsest level where it can.
  Pyramid(const image::Plane& luma, const PixelBox& part, int levels);

  int left() const { return left_; }
  int top() const { return top_; }
  int width(int level) const { return levels_[static_cast<std::size_t>(level)].width; }
  int height(int level) const { return levels_[static_cast<std::size_t>(level)].height; }

  // Sum over [x, x + width) by [y, y + height) of a level, in grey levels times four to its power.
  float sum(int level, int x, int y, int width, int height) const {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    const std::uint32_t* above = l.sums.data() + static_cast<std::ptrdiff_t>(y) * l.stride + x;
    const std::uint32_t* below = above + static_cast<std::ptrdiff_t>(height) * l.stride;
    return static_cast<float>(below[width] - below[0] - above[width] + above[0]);
  }
  // Offsets of a box's corners from a position's, for many positions of one level.
  std::ptrdiff_t stride(int level) const { return levels_[static_cast<std::size_t>(level)].stride; }
  const std::uint32_t* sums(int level) const {
    return levels_[static_cast<std::size_t>(level)].sums.data();
  }

 private:
  struct Level {
    int width = 0;
    int height = 0;
    std::ptrdiff_t stride = 0;
    std::vector<std::uint32_t> sums;  // (height + 1) x (width + 1), modulo 2^32
  };

  int left_ = 0;
  int top_ = 0;
  std::vector<Level> levels_;
};

}  // namespace airtruth::tracking
