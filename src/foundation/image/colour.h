// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"

// Converts between the samples of a picture and linear light.
//
// Linear RGB has the sRGB primaries; 1 is the brightest code value. Video is decoded with the
// transfer curve of sRGB (IEC 61966-2-1), because screens show such video with this curve.
namespace airtruth::image {

using Rgb = std::array<float, 3>;

// The exact piecewise curve of sRGB, from 0..1 to 0..1. Values outside this range are clamped.
float linear_from_srgb(float coded);
float srgb_from_linear(float linear);

// Converts Y', Cb, Cr as code values (0..255, may be fractional) to coded R'G'B' (nominally 0..1,
// values beyond are kept) and back. For Matrix::kRgb the three values are G, B, R. Each function is
// the exact inverse of the other up to rounding to float.
struct Ycc {
  float y = 0;
  float cb = 128;
  float cr = 128;
};
class ColourCode {
 public:
  explicit ColourCode(const Colour& colour);
  Rgb rgb_from_ycc(const Ycc& ycc) const;  // coded R'G'B'
  Ycc ycc_from_rgb(const Rgb& rgb) const;
  // Luma in code values: y, or for Matrix::kRgb that of BT.601. It is linear: the luma of a change
  // is the change of luma.
  float luma(const Ycc& ycc) const {
    return rgb_planes_ ? kr_ * ycc.cr + kg_ * ycc.y + kb_ * ycc.cb : ycc.y;
  }

 private:
  bool rgb_planes_ = false;
  float kr_ = 0, kg_ = 0, kb_ = 0;
  float y_scale_ = 0, y_offset_ = 0, c_scale_ = 0;
};

inline Rgb ColourCode::rgb_from_ycc(const Ycc& ycc) const {
  if (rgb_planes_) {
    return {(ycc.cr - y_offset_) / y_scale_,
            (ycc.y - y_offset_) / y_scale_,
            (ycc.cb - y_offset_) / y_scale_};
  }
  const float y = (ycc.y - y_offset_) / y_scale_;
  const float r = y + 2 * (1 - kr_) * (ycc.cr - 128) / c_scale_;
  const float b = y + 2 * (1 - kb_) * (ycc.cb - 128) / c_scale_;
  return {r, (y - kr_ * r - kb_ * b) / kg_, b};
}

inline Ycc ColourCode::ycc_from_rgb(const Rgb& rgb) const {
  if (rgb_planes_)
    return {rgb[1] * y_scale_ + y_offset_,
            rgb[2] * y_scale_ + y_offset_,
            rgb[0] * y_scale_ + y_offset_};
  const float y = kr_ * rgb[0] + kg_ * rgb[1] + kb_ * rgb[2];
  return {y * y_scale_ + y_offset_,
          (rgb[2] - y) / (2 * (1 - kb_)) * c_scale_ + 128,
          (rgb[0] - y) / (2 * (1 - kr_)) * c_scale_ + 128};
}

// The linear light of one pixel. All pixels of a chroma block have the block's chroma.
Rgb linear_at(
    const Picture& picture, const ColourCode& code, int x, int y, const ToneCurve& tone = {});

// The luma of a pixel in code values, Y as it is, or of red, green and blue that of BT.601 in the
// integers of OpenCV.
inline std::uint8_t luma_of_rgb(int red, int green, int blue) {
  return static_cast<std::uint8_t>((9798 * red + 19235 * green + 3735 * blue + 16384) >> 15);
}
inline std::uint8_t luma_at(const Picture& picture, int x, int y) {
  const std::uint8_t first = picture.planes[0].row(y)[x];
  if (picture.colour.matrix != Matrix::kRgb) return first;
  return luma_of_rgb(picture.planes[2].row(y)[x], first, picture.planes[1].row(y)[x]);
}
// That of `count` pixels of a row, from (x, y) on.
void copy_luma(const Picture& picture, int x, int y, int count, std::uint8_t* target);

// The whole picture as packed sRGB for previews and stills. All pixels of a chroma block have the
// block's chroma.
Rgb8 rgb8_from_picture(const Picture& picture);

// A part of a picture as packed sRGB. Pixels outside the picture are black.
Rgb8 rgb8_from_picture(const Picture& picture, const PixelBox& part);

// A picture from packed sRGB. Chroma is the average over its block.
Picture picture_from_rgb8(const Rgb8& rgb, const Colour& colour);

// Copies every `step`-th of the source's bytes: one component of packed pixels.
void take_every(const std::uint8_t* source, int step, int count, std::uint8_t* target);

}  // namespace airtruth::image
