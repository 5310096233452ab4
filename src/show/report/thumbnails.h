// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

// Small pictures for pages.
namespace airtruth::report {

// The whole picture, at most `width` pixels wide.
image::Rgb8 small_copy(const image::Rgb8& picture, int width);

// A square around a box, `side` pixels large, with some of its surroundings. Black where a square
// sticks out of the picture, here and below.
image::Rgb8 enlarged(const image::Picture& picture, const Box& box, int side);

// The square of `px` from (x, y) on, `side` pixels large.
image::Rgb8 square(const image::Picture& picture, double x, double y, double px, int side);

// Pictures of one size, side by side.
image::Rgb8 strip(const std::vector<image::Rgb8>& pictures);

// How far the luma within a box is from that around it, in levels: root mean square difference from
// the median of a ring as wide as the box's shorter side (at least 4 px).
double contrast(const image::Picture& picture, const PixelBox& box);

}  // namespace airtruth::report
