// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/colour.h"

#include <algorithm>
#include <cmath>

namespace airtruth::image {
namespace {

std::uint8_t code(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
}

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

namespace {

constexpr std::size_t kBlock = 16;
using Floats = std::array<float, kBlock>;

// What each code value adds to coded R'G'B', so that a pixel needs one division in place of four.
// The values are those of ColourCode::rgb_from_ycc(), bit for bit.
class CodeTables {
 public:
  explicit CodeTables(const Colour& colour)
      : is_rgb_(colour.matrix == Matrix::kRgb), weights_(weights_of(colour.matrix)) {
    const ColourCode code(colour);
    const float black = colour.range == Range::kLimited ? 16.0f : 0.0f;
    for (std::size_t i = 0; i < luma_.size(); ++i) {
      const auto value = static_cast<float>(i);
      luma_[i] = code.rgb_from_ycc({value, value, value})[1];
      if (is_rgb_) continue;
      luma_[i] = code.rgb_from_ycc({value, 128, 128})[0];
      red_[i] = code.rgb_from_ycc({black, 128, value})[0];
      blue_[i] = code.rgb_from_ycc({black, value, 128})[2];
    }
  }

  // Coded R'G'B' of pixel i of a block.
  void set(std::array<Floats, 3>& rgb,
           std::size_t i,
           std::uint8_t luma,
           std::uint8_t cb,
           std::uint8_t cr) const {
    if (is_rgb_) {
      rgb[0][i] = luma_[cr], rgb[1][i] = luma_[luma], rgb[2][i] = luma_[cb];
      return;
    }
    rgb[1][i] = luma_[luma];
    rgb[0][i] = rgb[1][i] + red_[cr];
    rgb[2][i] = rgb[1][i] + blue_[cb];
  }
  // Replaces luma by green, where the planes are not green already.
  void finish(std::array<Floats, 3>& rgb) const {
    if (is_rgb_) return;
    for (std::size_t i = 0; i < kBlock; ++i)
      rgb[1][i] = (rgb[1][i] - weights_.kr * rgb[0][i] - weights_.kb * rgb[2][i]) / weights_.kg;
  }

 private:
  bool is_rgb_;
  Weights weights_;
  std::array<float, 256> luma_{}, red_{}, blue_{};
};

// Writes the codes of the block's first `count` pixels.
void store(const std::array<Floats, 3>& rgb, std::size_t count, std::uint8_t* target) {
  std::array<std::array<int, kBlock>, 3> codes;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < kBlock; ++i)
      codes[c][i] = static_cast<int>(std::clamp(rgb[c][i] * 255.0f, 0.0f, 255.0f) + 0.5f);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c) target[3 * i + c] = static_cast<std::uint8_t>(codes[c][i]);
}

}  // namespace

Rgb8 rgb8_from_picture(const Picture& picture, int x0, int y0, int width, int height) {
  constexpr std::uint8_t kNoChroma = 128;
  Rgb8 result = make_rgb8(width, height);
  const CodeTables tables(picture.colour);
  const int sx = log2_chroma_width(picture.colour.chroma);
  const int sy = log2_chroma_height(picture.colour.chroma);
  const bool is_grey = picture.plane_count == 1;
  const int x_end = std::min(width, picture.width - x0);
  std::array<Floats, 3> rgb{};
  for (int y = std::max(0, -y0); y < std::min(height, picture.height - y0); ++y) {
    const std::uint8_t* luma = picture.planes[0].row(y0 + y);
    const std::uint8_t* cb = is_grey ? nullptr : picture.planes[1].row((y0 + y) >> sy);
    const std::uint8_t* cr = is_grey ? nullptr : picture.planes[2].row((y0 + y) >> sy);
    for (int x = std::max(0, -x0); x < x_end; x += int{kBlock}) {
      const auto count = static_cast<std::size_t>(std::min(int{kBlock}, x_end - x));
      for (std::size_t i = 0; i < count; ++i) {
        const int at = x0 + x + static_cast<int>(i);
        tables.set(rgb,
                   i,
                   luma[at],
                   is_grey ? kNoChroma : cb[at >> sx],
                   is_grey ? kNoChroma : cr[at >> sx]);
      }
      tables.finish(rgb);
      store(rgb, count, result.at(x, y));
    }
  }
  return result;
}

Rgb8 rgb8_from_picture(const Picture& picture) {
  return rgb8_from_picture(picture, 0, 0, picture.width, picture.height);
}

Picture picture_from_rgb8(const Rgb8& rgb, const Colour& colour) {
  Picture picture = make_picture(rgb.width, rgb.height, colour);
  const ColourCode colour_code(colour);
  std::array<float, 256> coded{};
  for (std::size_t i = 0; i < coded.size(); ++i) coded[i] = static_cast<float>(i) / 255.0f;
  // Beyond the right and lower edges, the pixels of the edge are repeated.
  const auto ycc = [&](int x, int y) {
    const std::uint8_t* p = rgb.at(std::min(x, rgb.width - 1), std::min(y, rgb.height - 1));
    return colour_code.ycc_from_rgb({coded[p[0]], coded[p[1]], coded[p[2]]});
  };
  const bool is_grey = picture.plane_count == 1;
  const int sx = is_grey ? 0 : log2_chroma_width(colour.chroma);
  const int sy = is_grey ? 0 : log2_chroma_height(colour.chroma);
  const float weight = 1.0f / static_cast<float>((1 << sx) * (1 << sy));
  for (int cy = 0; cy << sy < rgb.height; ++cy) {
    for (int cx = 0; cx << sx < rgb.width; ++cx) {
      float cb = 0;
      float cr = 0;
      for (int y = cy << sy; y < (cy + 1) << sy; ++y) {
        for (int x = cx << sx; x < (cx + 1) << sx; ++x) {
          const Ycc value = ycc(x, y);
          if (x < rgb.width && y < rgb.height) picture.planes[0].row(y)[x] = code(value.y);
          cb += value.cb * weight;
          cr += value.cr * weight;
        }
      }
      if (is_grey) continue;
      picture.planes[1].row(cy)[cx] = code(cb);
      picture.planes[2].row(cy)[cx] = code(cr);
    }
  }
  return picture;
}

}  // namespace airtruth::image
