// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

// Small pictures for HTML pages, and the pages' JPEGs with boxes.
namespace airtruth::drawing {

// The whole picture, at most `width` pixels wide.
image::Rgb8 small_copy(const image::Rgb8& picture, int width);

// A square around a box, `side` pixels large, with some of its surroundings. The parts of a square
// that lie outside of the picture are black, here and in square().
image::Rgb8 enlarged(const image::Picture& picture, const Box& box, int side);

// The square that starts at (x, y) and is `px` pixels large, scaled to `side` pixels.
image::Rgb8 square(const image::Picture& picture, double x, double y, double px, int side);

// Pictures of one size, side by side.
image::Rgb8 strip(const std::vector<image::Rgb8>& pictures);

struct ColouredBox {
  Box box;
  std::array<std::uint8_t, 3> rgb{};
};

// The picture of a JPEG with boxes drawn on it. Each box has a dark rim, and later boxes are drawn
// over earlier ones. `scale`: pixels of the JPEG for each pixel of the boxes. Error where the bytes
// are not a JPEG.
image::Rgb8 boxed(const std::string& jpeg, double scale, const std::vector<ColouredBox>& boxes);

// The contrast of a box's luma to its surroundings, in levels: the root mean square difference from
// the median of a ring that is as wide as the box's shorter side (at least 4 px).
double contrast(const image::Picture& picture, const PixelBox& box);

}  // namespace airtruth::drawing
