// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/colour.h"

#include <algorithm>
#include <cmath>

namespace airtruth::image {
namespace {

// The weights of red, green and blue in luma (ITU-T H.273, table 4). For RGB, those of BT.601.
struct Weights {
  float kr = 0, kg = 0, kb = 0;
};
Weights weights_of(Matrix matrix) {
  float kr = 0.299f, kb = 0.114f;
  if (matrix == Matrix::kBt709) kr = 0.2126f, kb = 0.0722f;
  if (matrix == Matrix::kBt2020) kr = 0.2627f, kb = 0.0593f;
  return {kr, 1 - kr - kb, kb};
}

}  // namespace

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
  const Weights weights = weights_of(colour.matrix);
  kr_ = weights.kr, kg_ = weights.kg, kb_ = weights.kb;
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
