// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::tracking {

// Box sums of a part of a picture's luma at several resolutions. Each level is half of the one
// before (means of 2x2 pixels). Pixel (x, y) of level p begins at the full-resolution pixel (2^p x
// + left, 2^p y + top). Only the part is read, so the cost depends on the part's size and not on
// the picture's.
class Pyramid {
 public:
  // `part` is cut to the picture and grown, where possible, to whole pixels of the coarsest level.
  Pyramid(const image::Plane& luma, const PixelBox& part, int levels);

  int left() const { return left_; }
  int top() const { return top_; }
  int width(int level) const { return levels_[static_cast<std::size_t>(level)].width; }
  int height(int level) const { return levels_[static_cast<std::size_t>(level)].height; }

  // Returns the sum over [x, x + width) by [y, y + height) of a level, in units of 1 / 4^level grey
  // levels.
  float sum(int level, int x, int y, int width, int height) const {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    const std::uint32_t* above = l.sums.data() + static_cast<std::ptrdiff_t>(y) * l.stride + x;
    const std::uint32_t* below = above + static_cast<std::ptrdiff_t>(height) * l.stride;
    return static_cast<float>(below[width] - below[0] - above[width] + above[0]);
  }
  // The row pitch and the sums of a level, to add fixed corner offsets to many positions.
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
