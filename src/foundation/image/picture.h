// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "foundation/geometry/box.h"

namespace airtruth::image {

// How a picture's samples stand for colour. All 8-bit.
enum class Chroma { kNone, k420, k422, k440, k444 };  // kNone: grey
enum class Matrix {
  kRgb,
  kBt601,
  kBt709,
  kBt2020
};                                     // kRgb: planes are G, B, R at full size (Chroma::k444)
enum class Range { kLimited, kFull };  // luma 16..235, chroma 16..240; or 0..255
enum class Siting {
  kLeft,
  kCenter,
  kTopLeft
};  // where a subsampled chroma sample sits (4:2:0 and 4:2:2)

struct Colour {
  Chroma chroma = Chroma::k420;
  Matrix matrix = Matrix::kBt601;
  Range range = Range::kLimited;
  Siting siting = Siting::kLeft;
  bool operator==(const Colour&) const = default;
};

// One plane of samples, rows `stride` bytes apart. Memory is not zeroed when made.
struct Plane {
  int width = 0;
  int height = 0;
  int stride = 0;
  std::unique_ptr<std::uint8_t[]> samples;

  std::uint8_t* row(int y) { return samples.get() + static_cast<std::ptrdiff_t>(y) * stride; }
  const std::uint8_t* row(int y) const {
    return samples.get() + static_cast<std::ptrdiff_t>(y) * stride;
  }
};

// A frame as its decoder left it: Y, Cb, Cr (or Y alone, or G, B, R). A chroma plane of an
// odd-sized picture is (size + 1) / 2. Movable; copy with clone().
struct Picture {
  int width = 0;
  int height = 0;
  Colour colour;
  int plane_count = 0;
  std::array<Plane, 3> planes;

  const Plane& luma() const { return planes[0]; }  // for kRgb: the green plane
  Picture clone() const;
};

// 1 where the chroma of this layout is halved, else 0.
int log2_chroma_width(Chroma chroma);
int log2_chroma_height(Chroma chroma);

Picture make_picture(int width, int height, const Colour& colour);

// The part of a picture within `box`, which lies inside it and begins on even numbers where chroma
// is halved.
Picture crop(const Picture& picture, const PixelBox& box);
// Writes `part` over `picture`, its corner at (x, y), which are even where chroma is halved; what
// lies outside the picture is left out. Both have one colour.
void paste(Picture& picture, const Picture& part, int x, int y);

// Every sample equal (padding between rows does not count) and same size and colour.
bool identical(const Picture& a, const Picture& b);

// Packed 8-bit sRGB, for stills, plots and masks: red, green, blue by pixel, no padding.
struct Rgb8 {
  int width = 0;
  int height = 0;
  std::unique_ptr<std::uint8_t[]> samples;  // width * height * 3
  std::uint8_t* at(int x, int y) {
    return samples.get() + 3 * (static_cast<std::ptrdiff_t>(y) * width + x);
  }
  const std::uint8_t* at(int x, int y) const {
    return samples.get() + 3 * (static_cast<std::ptrdiff_t>(y) * width + x);
  }
};

Rgb8 make_rgb8(int width, int height);  // black

}  // namespace airtruth::image
