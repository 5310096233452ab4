// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::tracking {

// Box sums of a part of a picture's luma at all resolutions of a pyramid, of which each level is
// half of the one before (means of 2x2 pixels). A box of a level consists of whole pixels of the
// part, so one integral picture has the sums of all levels, at every 2^level-th of its entries.
// Only the part is read, so the cost depends on the part's size and not on the picture's.
class Pyramid {
 public:
  // `part` is cut to the picture; pixel (0, 0) of every level begins at its corner.
  Pyramid(const image::Plane& luma, const PixelBox& part);

  int width(int level) const { return width_ >> level; }
  int height(int level) const { return height_ >> level; }

  // The sums, in grey levels, of what is above and to the left of each pixel, and the way in them
  // to a pixel of a level.
  const std::uint32_t* sums() const { return sums_.data(); }
  std::ptrdiff_t offset(int level, int x, int y) const { return (y * stride_ + x) << level; }

 private:
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<std::uint32_t> sums_;  // (height + 1) x (width + 1), modulo 2^32
};

// Part of a picture's luma at several resolutions. Each of its pixels is `scale` pixels of the
// picture wide.
struct LumaWindow {
  Pyramid pyramid;
  double left = 0;  // position of the pyramid's corner in the picture, px
  double top = 0;
  double scale = 1;
};

// Resamples `width` x `height` pixels, beginning at (left, top). Beyond the picture, its border
// pixels are repeated. The result is made from means of whole blocks with linear interpolation
// between them.
image::Plane resampled(
    const image::Plane& luma, double left, double top, double scale, int width, int height);

}  // namespace airtruth::tracking
