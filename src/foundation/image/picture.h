// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include "foundation/geometry/box.h"
#include "foundation/image/sample_memory.h"

namespace airtruth::image {

// How the samples of a picture encode colour. All samples have 8 bits.
// The chroma subsampling; kNone is a grey picture.
enum class Chroma { kNone, k420, k422, k440, k444 };
// The matrix between Y'CbCr and R'G'B'. For kRgb the planes are G, B, R at full size
// (Chroma::k444).
enum class Matrix { kRgb, kBt601, kBt709, kBt2020 };
// kLimited: luma 16..235 and chroma 16..240. kFull: 0..255.
enum class Range { kLimited, kFull };
// The position of a subsampled chroma sample (4:2:0 and 4:2:2).
enum class Siting { kLeft, kCenter, kTopLeft };

struct Colour {
  Chroma chroma = Chroma::k420;
  Matrix matrix = Matrix::kBt601;
  Range range = Range::kLimited;
  Siting siting = Siting::kLeft;
  bool operator==(const Colour&) const = default;
};

// One plane of samples. Rows begin `stride` bytes apart. The memory is not initialised.
struct Plane {
  int width = 0;
  int height = 0;
  int stride = 0;
  SampleMemory samples;

  std::uint8_t* row(int y) { return samples.get() + static_cast<std::ptrdiff_t>(y) * stride; }
  const std::uint8_t* row(int y) const {
    return samples.get() + static_cast<std::ptrdiff_t>(y) * stride;
  }
};

// A frame in the planes of its decoder: Y, Cb, Cr, or Y alone, or G, B, R. A halved side of a
// chroma plane has (size + 1) / 2 samples. A Picture is movable; clone() copies it.
struct Picture {
  int width = 0;
  int height = 0;
  Colour colour;
  int plane_count = 0;
  std::array<Plane, 3> planes;

  // The first plane: for kRgb green, of which luma_at() and copy_luma() (colour.h) make luma.
  const Plane& luma() const { return planes[0]; }
  Picture clone() const;
  std::size_t bytes() const;  // of all planes
};

// 1 where this layout halves the width or height of chroma, else 0.
int log2_chroma_width(Chroma chroma);
int log2_chroma_height(Chroma chroma);

Picture make_picture(int width, int height, const Colour& colour);

// The part of a picture within `box`. The box must lie inside the picture, and its corner must be
// even where chroma is halved.
Picture crop(const Picture& picture, const PixelBox& box);
// Writes `part` over `picture` with its corner at (x, y), which must be even where chroma is
// halved. The function skips pixels outside the picture. Both pictures must have the same Colour.
void paste(Picture& picture, const Picture& part, int x, int y);

// Whether both pictures have the same size, Colour and samples. Padding between rows is ignored.
bool identical(const Picture& a, const Picture& b);

// Packed 8-bit sRGB for stills, plots and masks: red, green and blue of each pixel, no padding.
struct Rgb8 {
  int width = 0;
  int height = 0;
  std::unique_ptr<std::uint8_t[]> samples;  // width * height * 3
  std::string_view bytes() const {
    return {reinterpret_cast<const char*>(samples.get()), 3 * pixels_in(width, height)};
  }
  std::uint8_t* at(int x, int y) {
    return samples.get() + 3 * (static_cast<std::ptrdiff_t>(y) * width + x);
  }
  const std::uint8_t* at(int x, int y) const {
    return samples.get() + 3 * (static_cast<std::ptrdiff_t>(y) * width + x);
  }
};

Rgb8 make_rgb8(int width, int height);  // black

}  // namespace airtruth::image
