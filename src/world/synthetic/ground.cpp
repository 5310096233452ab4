// SPDX-License-Identifier: Apache-2.0
#include "world/synthetic/ground.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace airtruth::synthetic {
namespace {

// Number of steps through the height field.
constexpr int kMarch = 7;
// Beyond this distance the ground is flat.
constexpr float kReliefEnd_m = 5000;
// Distance at which the hills begin.
constexpr float kFarthest_m = 26000;
constexpr float kPeakCell_m = 10;
constexpr float kDetail_m = 0.4F;

// Bilinear interpolation of four bytes at once, each in 16 bits of a word.
inline std::uint64_t spread(std::uint32_t t) {
  return (t & 0x00FF00FFU) | (static_cast<std::uint64_t>((t >> 8) & 0x00FF00FFU) << 32);
}

// Red, blue, green and height, each as 0..255 times 256.
[[gnu::always_inline]] inline std::uint64_t bilinear(const std::uint32_t* texels,
                                                     int size,
                                                     float x,
                                                     float y) {
  const int ix = floor_int(x);
  const int iy = floor_int(y);
  const auto fx = static_cast<std::uint32_t>((x - static_cast<float>(ix)) * 16);
  const auto fy = static_cast<std::uint32_t>((y - static_cast<float>(iy)) * 16);
  const int wrap = size - 1;
  const std::uint32_t* upper = texels + static_cast<std::ptrdiff_t>(iy & wrap) * size;
  const std::uint32_t* lower = texels + static_cast<std::ptrdiff_t>((iy + 1) & wrap) * size;
  const int left = ix & wrap;
  const int right = (ix + 1) & wrap;
  return spread(upper[left]) * ((16 - fx) * (16 - fy)) + spread(upper[right]) * (fx * (16 - fy)) +
         spread(lower[left]) * ((16 - fx) * fy) + spread(lower[right]) * (fx * fy);
}

// Base-2 logarithm with an error below 0.09, which suffices to choose a mip level.
float fast_log2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return static_cast<float>(bits) * 0x1p-23F - 126.94F;
}

LinearRgb unpack(std::uint64_t word) {
  return {static_cast<float>(word & 0xFFFF),
          static_cast<float>((word >> 32) & 0xFFFF),
          static_cast<float>((word >> 16) & 0xFFFF),
          static_cast<float>(word >> 48)};
}

}  // namespace

LinearRgb Ground::haze(float north, float east) const {
  const float cosine = std::clamp(
      north * static_cast<float>(sun_.x()) + east * static_cast<float>(sun_.y()), -1.0F, 1.0F);
  const float at = (cosine * 0.5F + 0.5F) * (kHazeSectors - 1.001F);
  const auto i = static_cast<std::size_t>(at);
  return haze_[i] + (haze_[i + 1] - haze_[i]) * (at - static_cast<float>(i));
}

float Ground::height_m(float x, float y, int level) const {
  const Level& mip = levels_[static_cast<std::size_t>(level)];
  const float scale = 1.0F / static_cast<float>(1 << level);
  const int wrap = mip.size - 1;
  const int ix = floor_int(x * scale) & wrap;
  const int iy = floor_int(y * scale) & wrap;
  return static_cast<float>(
             mip.texels[static_cast<std::size_t>(iy) * static_cast<std::size_t>(mip.size) +
                        static_cast<std::size_t>(ix)] >>
             24) *
         (kHighest_m / 255);
}

float Ground::smooth_height_m(float x, float y, int level) const {
  const Level& mip = levels_[static_cast<std::size_t>(level)];
  const float scale = 1.0F / static_cast<float>(1 << level);
  return static_cast<float>(
             bilinear(mip.texels.data(), mip.size, x * scale - 0.5F, y * scale - 0.5F) >> 48) *
         (kHighest_m / 65280);
}

// Trilinear interpolation at texel positions of level 0, measured from texel centres.
LinearRgb Ground::colour(float x, float y, float level) const {
  const float top = static_cast<float>(levels_.size() - 2);
  level = std::clamp(level, 0.0F, top);
  const int whole = std::min(static_cast<int>(level), static_cast<int>(top) - 1);
  const float part = level - static_cast<float>(whole);
  const auto at = [&](int i) {
    const float scale = 1.0F / static_cast<float>(1 << i);
    const Level& mip = levels_[static_cast<std::size_t>(i)];
    return unpack(bilinear(mip.texels.data(), mip.size, x * scale - 0.5F, y * scale - 0.5F));
  };
  const LinearRgb fine = at(whole);
  return (fine + (at(whole + 1) - fine) * part) * (1.0F / (256 * 255));
}

float Ground::sunlit(float north_m, float east_m) const {
  const float scale = kShadowCells / static_cast<float>(Clouds::period_m());
  const float x = north_m * scale;
  const float y = east_m * scale;
  const int ix = floor_int(x);
  const int iy = floor_int(y);
  const auto at = [&](int i, int j) {
    return shadow_[static_cast<std::size_t>(((iy + j) & (kShadowCells - 1)) * kShadowCells +
                                            ((ix + i) & (kShadowCells - 1)))];
  };
  const float fx = x - static_cast<float>(ix);
  return lerp(
      lerp(at(0, 0), at(1, 0), fx), lerp(at(0, 1), at(1, 1), fx), y - static_cast<float>(iy));
}

float Ground::detail(float north_m, float east_m) const {
  const float x = north_m / kDetail_m;
  const float y = east_m / kDetail_m;
  const int ix = floor_int(x);
  const int iy = floor_int(y);
  const auto at = [&](int i, int j) {
    return detail_[static_cast<std::size_t>(((iy + j) & (kDetailCells - 1)) * kDetailCells +
                                            ((ix + i) & (kDetailCells - 1)))];
  };
  const float fx = x - static_cast<float>(ix);
  return lerp(
      lerp(at(0, 0), at(1, 0), fx), lerp(at(0, 1), at(1, 1), fx), y - static_cast<float>(iy));
}

float Ground::peak_m(float north_m, float east_m, float span_m) const {
  std::size_t level = 0;
  float cell_m = kPeakCell_m;
  while (2 * cell_m < span_m && level + 1 < peaks_.size()) {
    cell_m *= 2;
    ++level;
  }
  const int cells = static_cast<int>(kLand_m / cell_m);
  const int x = floor_int(north_m / cell_m) & (cells - 1);
  const int y = floor_int(east_m / cell_m) & (cells - 1);
  return static_cast<float>(peaks_[level][static_cast<std::size_t>(y * cells + x)]) *
         (kHighest_m / 255);
}

std::optional<Ground::Meeting> Ground::meet(float eye_north_m,
                                            float eye_east_m,
                                            float north,
                                            float east,
                                            float down,
                                            float far_m,
                                            float across) const {
  const float span_m = kHighest_m / down;
  const float middle_m = far_m - 0.5F * span_m;
  const float peak = peak_m(eye_north_m + middle_m * north, eye_east_m + middle_m * east, span_m);
  if (peak <= 0) return std::nullopt;
  const float inverse = 1 / texel_m_;
  const float step = peak / down / kMarch;
  const int level = std::clamp(static_cast<int>(std::max(across, fast_log2(step * 0.4F * inverse))),
                               0,
                               static_cast<int>(levels_.size()) - 2);
  const auto x = [&](float s) { return (eye_north_m + s * north) * inverse; };
  const auto y = [&](float s) { return (eye_east_m + s * east) * inverse; };
  const int refinements = far_m < 600 ? 4 : 2;
  float clear = far_m - peak / down;
  for (int i = 0; i < kMarch; ++i) {
    float inside = clear + step;
    if ((far_m - inside) * down >= height_m(x(inside), y(inside), level)) {
      clear = inside;
      continue;
    }
    for (int k = 0; k < refinements; ++k) {
      const float s = 0.5F * (clear + inside);
      ((far_m - s) * down < smooth_height_m(x(s), y(s), level) ? inside : clear) = s;
    }
    const float ray_m = (far_m - inside) * down;
    const float behind = inside + 0.8F * texel_m_;
    const float top_m = smooth_height_m(x(behind), y(behind), level);
    return Meeting{inside, 1 - 0.5F * clamp01((top_m - ray_m) / (0.6F * peak))};
  }
  return std::nullopt;
}

LinearRgb Ground::seen(float eye_north_m,
                       float eye_east_m,
                       float eye_height_m,
                       float north,
                       float east,
                       float down) const {
  const float far_m = eye_height_m / std::max(down, 1e-5F);
  const float reach_m = std::min(far_m, kFarthest_m);
  const LinearRgb veil = haze(north, east);
  float t = reach_m;
  float shade = 1;
  const float inverse = 1 / texel_m_;
  const float across = fast_log2(std::max(t * pixel_rad_ * inverse, 0.01F));
  if (far_m < kReliefEnd_m && eye_height_m > kHighest_m) {
    if (const auto met = meet(eye_north_m, eye_east_m, north, east, down, far_m, across)) {
      t = met->distance_m;
      shade = met->shade;
    }
  }
  const float north_m = eye_north_m + t * north;
  const float east_m = eye_east_m + t * east;
  const float along = std::min(-fast_log2(std::max(down, 1e-4F)), 5.0F);
  const float x = north_m * inverse;
  const float y = east_m * inverse;
  const LinearRgb root = colour(x, y, across + 0.5F * along - 0.6F);
  LinearRgb albedo = root * root;
  if (t < 1200) albedo *= 1 + (1 - t / 1200) * (detail(north_m, east_m) - 0.5F) * 0.7F;
  const float lit = sunlit(north_m, east_m);
  const float fog = 1 - std::exp(-reach_m * extinction_per_m_);
  const LinearRgb up = albedo * (sunlight_ * lit + skylight_) * shade;
  return up + (veil - up) * fog;
}

}  // namespace airtruth::synthetic
