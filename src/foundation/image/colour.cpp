// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/colour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "foundation/base/vectors.h"

namespace airtruth::image {

float linear_from_srgb(float coded) {
  const float c = std::clamp(coded, 0.0f, 1.0f);
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

float srgb_from_linear(float linear) {
  const float l = std::clamp(linear, 0.0f, 1.0f);
  return l <= 0.0031308f ? 12.92f * l : 1.055f * std::pow(l, 1.0f / 2.4f) - 0.055f;
}

namespace {

// The offset of sRGB's power (IEC 61966-2-1), in coded values from 0 to 1.
constexpr double kOffset = 0.055;

struct Toe {
  double gamma, end, slope;  // below the coded value `end`, coded = slope * linear
};

Toe toe_of(double gamma) {
  if (gamma == 0) return {2.4, 0.04045, 12.92};  // IEC 61966-2-1 rounds them so
  const double end = kOffset / (gamma - 1);      // where the line is tangent to the power
  return {gamma, end, end / std::pow((end + kOffset) / (1 + kOffset), gamma)};
}

}  // namespace

double ToneCurve::linear_from_coded(double coded) const {
  const Toe toe = toe_of(gamma);
  return coded <= toe.end ? coded / toe.slope
                          : std::pow((coded + kOffset) / (1 + kOffset), toe.gamma);
}

double ToneCurve::coded_from_linear(double linear) const {
  const Toe toe = toe_of(gamma);
  return toe.slope * linear <= toe.end ? toe.slope * linear
                                       : (1 + kOffset) * std::pow(linear, 1 / toe.gamma) - kOffset;
}

float ToneCurve::linear_from_coded_clamped(float coded) const {
  if (gamma == 0) return linear_from_srgb(coded);
  return static_cast<float>(linear_from_coded(static_cast<double>(std::clamp(coded, 0.0F, 1.0F))));
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

// Pictures as packed sRGB and back. Samples are copied to blocks of floats, which the compiler
// converts by vectors.

namespace {

constexpr int kBlock = 64;  // pixels; the arrays of a block fit in the first-level cache
// Plain arrays: GCC does not vectorise loops over std::array.
using Codes = std::uint8_t[kBlock];
using Floats = float[kBlock];

inline std::uint8_t code_of(float value) {
  return static_cast<std::uint8_t>(static_cast<int>(std::clamp(value, 0.0f, 255.0f) + 0.5f));
}

// Planes of a block: Y', Cb and Cr, or R', G' and B'.
struct Block {
  alignas(64) Codes a;
  alignas(64) Codes b;
  alignas(64) Codes c;
};

AIRTRUTH_FOR_VECTORS void rgb_from_ycc(const Block& ycc, const ColourCode& colour, Block& rgb) {
  const ColourCode code = colour;
  alignas(64) Floats red, green, blue;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const Rgb value = code.rgb_from_ycc({float(ycc.a[i]), float(ycc.b[i]), float(ycc.c[i])});
    red[i] = value[0];
    green[i] = value[1];
    blue[i] = value[2];
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    rgb.a[i] = code_of(red[i] * 255.0f);
    rgb.b[i] = code_of(green[i] * 255.0f);
    rgb.c[i] = code_of(blue[i] * 255.0f);
  }
}

AIRTRUTH_FOR_VECTORS void interleave(const Block& rgb, std::size_t count, std::uint8_t* target) {
  for (std::size_t i = 0; i < count; ++i) {
    target[3 * i] = rgb.a[i];
    target[3 * i + 1] = rgb.b[i];
    target[3 * i + 2] = rgb.c[i];
  }
}

// Copies samples of a plane from pixel x on; one sample is that of 1 << shift pixels.
void spread(const Plane& plane, int x, int y, int shift, std::size_t count, Codes& target) {
  const std::uint8_t* row = plane.row(y);
  if (shift == 0) {
    std::copy_n(row + x, count, target);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) target[i] = row[(x + static_cast<int>(i)) >> shift];
}

AIRTRUTH_FOR_VECTORS void take_every_third(const std::uint8_t* source,
                                           int count,
                                           std::uint8_t* target) {
  for (int x = 0; x < count; ++x) target[x] = source[3 * x];
}

AIRTRUTH_FOR_VECTORS void take_every_fourth(const std::uint8_t* source,
                                            int count,
                                            std::uint8_t* target) {
  for (int x = 0; x < count; ++x) target[x] = source[4 * x];
}

AIRTRUTH_FOR_VECTORS void luma_of_rgb_by_vectors(const std::uint8_t* red,
                                                 const std::uint8_t* green,
                                                 const std::uint8_t* blue,
                                                 int count,
                                                 std::uint8_t* target) {
  for (int x = 0; x < count; ++x) target[x] = luma_of_rgb(red[x], green[x], blue[x]);
}

}  // namespace

// Functions with several variants are private: GCC exports their names whatever their visibility.
void take_every(const std::uint8_t* source, int step, int count, std::uint8_t* target) {
  if (step == 3) return take_every_third(source, count, target);
  if (step == 4) return take_every_fourth(source, count, target);
  for (int x = 0; x < count; ++x) target[x] = source[x * step];
}

void copy_luma(const Picture& picture, int x, int y, int count, std::uint8_t* target) {
  const auto from = [&](std::size_t plane) { return picture.planes[plane].row(y) + x; };
  if (picture.colour.matrix == Matrix::kRgb)
    luma_of_rgb_by_vectors(from(2), from(0), from(1), count, target);
  else
    std::copy_n(from(0), count, target);
}

Rgb8 rgb8_from_picture(const Picture& picture, const PixelBox& part) {
  // The code value of grey in Cb and Cr.
  constexpr std::uint8_t kNoChroma = 128;
  Rgb8 result = make_rgb8(part.width, part.height);
  const ColourCode code(picture.colour);
  const int sx = log2_chroma_width(picture.colour.chroma);
  const int sy = log2_chroma_height(picture.colour.chroma);
  const int x_end = std::min(part.width, picture.width - part.x);
  Block ycc, rgb;
  for (Codes* codes : {&ycc.a, &ycc.b, &ycc.c}) std::fill_n(*codes, kBlock, kNoChroma);
  for (int y = std::max(0, -part.y); y < std::min(part.height, picture.height - part.y); ++y) {
    for (int x = std::max(0, -part.x); x < x_end; x += kBlock) {
      const auto count = static_cast<std::size_t>(std::min(kBlock, x_end - x));
      spread(picture.planes[0], part.x + x, part.y + y, 0, count, ycc.a);
      if (picture.plane_count == 3) {
        spread(picture.planes[1], part.x + x, (part.y + y) >> sy, sx, count, ycc.b);
        spread(picture.planes[2], part.x + x, (part.y + y) >> sy, sx, count, ycc.c);
      }
      rgb_from_ycc(ycc, code, rgb);
      interleave(rgb, count, result.at(x, y));
    }
  }
  return result;
}

Rgb8 rgb8_from_picture(const Picture& picture) {
  return rgb8_from_picture(picture, {0, 0, picture.width, picture.height});
}

namespace {

// A block of Y', rounded, with its chroma.
struct CodedBlock {
  alignas(64) Codes luma;
  alignas(64) Floats cb;
  alignas(64) Floats cr;
};

// `packed` has kBlock pixels.
AIRTRUTH_FOR_VECTORS void ycc_from_rgb(const std::uint8_t* packed,
                                       const ColourCode& colour,
                                       CodedBlock& coded) {
  const ColourCode code = colour;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const Ycc value = code.ycc_from_rgb({float(packed[3 * i]) / 255.0f,
                                         float(packed[3 * i + 1]) / 255.0f,
                                         float(packed[3 * i + 2]) / 255.0f});
    coded.luma[i] = code_of(value.y);
    coded.cb[i] = value.cb;
    coded.cr[i] = value.cr;
  }
}

// Adds a row of chroma to the sums of its blocks, from left to right.
void add_chroma(const Floats& from, int shift, float weight, float* sums, std::size_t count) {
  if (shift == 0) {
    for (std::size_t i = 0; i < count; ++i) sums[i] += from[i] * weight;
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    sums[i] += from[2 * i] * weight;
    sums[i] += from[2 * i + 1] * weight;
  }
}

void round_row(const std::vector<float>& sums, std::uint8_t* row, int count) {
  for (int i = 0; i < count; ++i) row[i] = code_of(sums[static_cast<std::size_t>(i)]);
}

// The pixels of a block from (x, y) on. Beyond the right and lower edges, the pixels of the edge
// are repeated.
void copy_pixels(const Rgb8& rgb, int x, int y, std::array<std::uint8_t, 3 * kBlock>& pixels) {
  const int inside = std::min(kBlock, rgb.width - x);
  const int row = std::min(y, rgb.height - 1);
  std::copy_n(rgb.at(x, row), 3 * inside, pixels.begin());
  for (int i = inside; i < kBlock; ++i)
    std::copy_n(rgb.at(rgb.width - 1, row), 3, pixels.begin() + 3 * i);
}

}  // namespace

Picture picture_from_rgb8(const Rgb8& rgb, const Colour& colour) {
  Picture picture = make_picture(rgb.width, rgb.height, colour);
  const ColourCode code(colour);
  const bool is_grey = picture.plane_count == 1;
  const int sx = is_grey ? 0 : log2_chroma_width(colour.chroma);
  const int sy = is_grey ? 0 : log2_chroma_height(colour.chroma);
  const float weight = 1.0f / static_cast<float>((1 << sx) * (1 << sy));
  const int wide = ((rgb.width - 1) / kBlock + 1) * kBlock >> sx;
  std::array<std::uint8_t, 3 * kBlock> pixels;
  CodedBlock coded;
  for (int cy = 0; cy << sy < rgb.height; ++cy) {
    std::vector<float> cb(static_cast<std::size_t>(wide)), cr(cb);
    for (int y = cy << sy; y < (cy + 1) << sy; ++y) {
      for (int x = 0; x < rgb.width; x += kBlock) {
        copy_pixels(rgb, x, y, pixels);
        ycc_from_rgb(pixels.data(), code, coded);
        if (y < rgb.height)
          std::copy_n(coded.luma, std::min(kBlock, rgb.width - x), picture.planes[0].row(y) + x);
        add_chroma(coded.cb, sx, weight, cb.data() + (x >> sx), kBlock >> sx);
        add_chroma(coded.cr, sx, weight, cr.data() + (x >> sx), kBlock >> sx);
      }
    }
    if (is_grey) continue;
    round_row(cb, picture.planes[1].row(cy), picture.planes[1].width);
    round_row(cr, picture.planes[2].row(cy), picture.planes[2].width);
  }
  return picture;
}

}  // namespace airtruth::image
