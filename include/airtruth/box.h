// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace airtruth {

// An axis-parallel box in pixels, with fractions. It covers [x, x + width) and [y, y + height). The
// point (0, 0) is the top-left corner of the image, and the centre of the first pixel is
// (0.5, 0.5).
//
// Example: {100, 50, 20, 10} has its centre at (110, 55) and covers the pixel columns 100 to 119.
struct Box {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
  double area() const { return width * height; }
  bool operator==(const Box&) const = default;
};

// A box of whole pixels: the columns x to x + width - 1 and the rows y to y + height - 1. It is
// never empty.
struct PixelBox {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  int right() const { return x + width; }
  int bottom() const { return y + height; }
  bool contains(int px, int py) const {
    return px >= x && py >= y && px < right() && py < bottom();
  }
  bool operator==(const PixelBox&) const = default;
};

}  // namespace airtruth
