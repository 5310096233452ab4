// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/colour.h"

#include <algorithm>
#include <cmath>

namespace airtruth::image {
namespace {

std::uint8_t code(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
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
  switch (colour.matrix) {  // ITU-T H.273, table 4
    case Matrix::kRgb:
    case Matrix::kBt601:
      kr_ = 0.299f, kb_ = 0.114f;
      break;
    case Matrix::kBt709:
      kr_ = 0.2126f, kb_ = 0.0722f;
      break;
    case Matrix::kBt2020:
      kr_ = 0.2627f, kb_ = 0.0593f;
      break;
  }
  kg_ = 1 - kr_ - kb_;
  const bool limited = colour.range == Range::kLimited;
  y_scale_ = limited ? 219.0f : 255.0f;
  y_offset_ = limited ? 16.0f : 0.0f;
  c_scale_ = limited ? 224.0f : 255.0f;
}

Rgb8 rgb8_from_picture(const Picture& picture, int x0, int y0, int width, int height) {
  Rgb8 result = make_rgb8(width, height);
  const ColourCode colour_code(picture.colour);
  const int sx = log2_chroma_width(picture.colour.chroma);
  const int sy = log2_chroma_height(picture.colour.chroma);
  const bool grey = picture.plane_count == 1;
  for (int y = std::max(0, -y0); y < std::min(height, picture.height - y0); ++y) {
    const std::uint8_t* luma = picture.planes[0].row(y0 + y) + x0;
    const std::uint8_t* cb = grey ? nullptr : picture.planes[1].row((y0 + y) >> sy);
    const std::uint8_t* cr = grey ? nullptr : picture.planes[2].row((y0 + y) >> sy);
    for (int x = std::max(0, -x0); x < std::min(width, picture.width - x0); ++x) {
      Ycc ycc{static_cast<float>(luma[x]), 128, 128};
      if (!grey) ycc.cb = cb[(x0 + x) >> sx], ycc.cr = cr[(x0 + x) >> sx];
      const Rgb rgb = colour_code.rgb_from_ycc(ycc);
      std::uint8_t* target = result.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) target[c] = code(rgb[c] * 255.0f);
    }
  }
  return result;
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

Rgb8 rgb8_from_picture(const Picture& picture) {
  return rgb8_from_picture(picture, 0, 0, picture.width, picture.height);
}

Picture picture_from_rgb8(const Rgb8& rgb, const Colour& colour) {
  Picture picture = make_picture(rgb.width, rgb.height, colour);
  const ColourCode colour_code(colour);
  const auto ycc = [&](int x, int y) {
    const std::uint8_t* p = rgb.at(std::min(x, rgb.width - 1), std::min(y, rgb.height - 1));
    return colour_code.ycc_from_rgb({p[0] / 255.0f, p[1] / 255.0f, p[2] / 255.0f});
  };
  for (int y = 0; y < rgb.height; ++y) {
    for (int x = 0; x < rgb.width; ++x) picture.planes[0].row(y)[x] = code(ycc(x, y).y);
  }
  if (picture.plane_count == 1) return picture;
  const int sx = log2_chroma_width(colour.chroma);
  const int sy = log2_chroma_height(colour.chroma);
  const float weight = 1.0f / static_cast<float>((1 << sx) * (1 << sy));
  for (int cy = 0; cy < picture.planes[1].height; ++cy) {
    for (int cx = 0; cx < picture.planes[1].width; ++cx) {
      float cb = 0;
      float cr = 0;
      for (int y = cy << sy; y < (cy + 1) << sy; ++y) {
        for (int x = cx << sx; x < (cx + 1) << sx; ++x) {
          const Ycc value = ycc(x, y);
          cb += value.cb * weight;
          cr += value.cr * weight;
        }
      }
      picture.planes[1].row(cy)[cx] = code(cb);
      picture.planes[2].row(cy)[cx] = code(cr);
    }
  }
  return picture;
}

}  // namespace airtruth::image
