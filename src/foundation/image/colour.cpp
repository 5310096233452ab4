// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/colour.h"

#include <algorithm>
#include <cmath>

namespace airtruth::image {

float linear_from_srgb(float coded) {
  const float c = std::clamp(coded, 0.0f, 1.0f);
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

float srgb_from_linear(float linear) {
  const float l = std::clamp(linear, 0.0f, 1.0f);
  return l <= 0.0031308f ? 12.92f * l : 1.055f * std::pow(l, 1.0f / 2.4f) - 0.055f;
}

ColourCode::ColourCode(const Colour& colour) {
  rgb_planes_ = colour.matrix == Matrix::kRgb;
  // The weights of red, green and blue in luma (ITU-T H.273, table 4). For RGB, those of BT.601.
  kr_ = 0.299f, kb_ = 0.114f;
  if (colour.matrix == Matrix::kBt709) kr_ = 0.2126f, kb_ = 0.0722f;
  if (colour.matrix == Matrix::kBt2020) kr_ = 0.2627f, kb_ = 0.0593f;
  kg_ = 1 - kr_ - kb_;
  const bool limited = colour.range == Range::kLimited;
  y_scale_ = limited ? 219.0f : 255.0f;
  y_offset_ = limited ? 16.0f : 0.0f;
  c_scale_ = limited ? 224.0f : 255.0f;
}

Rgb linear_at(const Picture& picture, const ColourCode& code, int x, int y, const ToneCurve& tone) {
  Ycc ycc;
  ycc.y = picture.planes[0].row(y)[x];
  if (picture.plane_count == 3) {
    const int cx = x >> log2_chroma_width(picture.colour.chroma);
    const int cy = y >> log2_chroma_height(picture.colour.chroma);
    ycc.cb = picture.planes[1].row(cy)[cx];
    ycc.cr = picture.planes[2].row(cy)[cx];
  }
  Rgb rgb = code.rgb_from_ycc(ycc);
  for (float& c : rgb) c = tone.linear_from_coded_clamped(c);
  return rgb;
}

}  // namespace airtruth::image
