// SPDX-License-Identifier: Apache-2.0
#include "synthetic/ground.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace airtruth::synthetic {
namespace {

constexpr float kHighest_m = 16;      // of trees and houses
constexpr int kMarch = 10;            // steps through the height field
constexpr float kReliefEnd_m = 3500;  // beyond, the ground is flat
constexpr float kVisibility_m = 17000;
constexpr float kFarthest_m = 26000;  // where the hills begin
constexpr int kShadowCells = 512;
constexpr int kDetailCells = 256;
constexpr float kDetail_m = 0.4F;
constexpr int kHazeSectors = 64;

// Two-way interpolation of four bytes at once, each in 16 bits of a word.
std::uint64_t spread(std::uint32_t t) {
  return (t & 0x00FF00FFU) | (static_cast<std::uint64_t>((t >> 8) & 0x00FF00FFU) << 32);
}

// red, blue, green, height as 0..255 * 256
std::uint64_t bilinear(const std::uint32_t* texels, int size, float x, float y) {
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

Light unpack(std::uint64_t word) {
  return {static_cast<float>(word & 0xFFFF),
          static_cast<float>((word >> 32) & 0xFFFF),
          static_cast<float>((word >> 16) & 0xFFFF),
          static_cast<float>(word >> 48)};
}

}  // namespace

Light Ground::haze(float north, float east) const {
  const float cosine = std::clamp(
      north * static_cast<float>(sun_.x()) + east * static_cast<float>(sun_.y()), -1.0F, 1.0F);
  const float at = (cosine * 0.5F + 0.5F) * (kHazeSectors - 1.001F);
  const auto i = static_cast<std::size_t>(at);
  return haze_[i] + (haze_[i + 1] - haze_[i]) * (at - static_cast<float>(i));
}

float Ground::height_m(float x, float y, int level) const {
  const float scale = 1.0F / static_cast<float>(1 << level);
  const Level& mip = levels_[static_cast<std::size_t>(level)];
  const int wrap = mip.size - 1;
  const int ix = static_cast<int>(std::floor(x * scale)) & wrap;
  const int iy = static_cast<int>(std::floor(y * scale)) & wrap;
  return static_cast<float>(
             mip.texels[static_cast<std::size_t>(iy) * static_cast<std::size_t>(mip.size) +
                        static_cast<std::size_t>(ix)] >>
             24) *
         (kHighest_m / 255);
}

// Trilinear; texel positions of level 0, measured from texel centres.
Light Ground::colour(float x, float y, float level) const {
  const float top = static_cast<float>(levels_.size() - 2);
  level = std::clamp(level, 0.0F, top);
  const int whole = std::min(static_cast<int>(level), static_cast<int>(top) - 1);
  const float part = level - static_cast<float>(whole);
  const auto at = [&](int i) {
    const float scale = 1.0F / static_cast<float>(1 << i);
    const Level& mip = levels_[static_cast<std::size_t>(i)];
    return unpack(bilinear(mip.texels.data(), mip.size, x * scale - 0.5F, y * scale - 0.5F));
  };
  const Light fine = at(whole);
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

Light Ground::seen(float eye_north_m,
                   float eye_east_m,
                   float eye_height_m,
                   float north,
                   float east,
                   float down) const {
  const float far_m = eye_height_m / std::max(down, 1e-5F);
  const float reach_m = std::min(far_m, kFarthest_m);
  const Light veil = haze(north, east);
  float t = reach_m;
  float shade = 1;
  const float inverse = 1 / texel_m_;
  const float across = std::log2(std::max(t * pixel_rad_ * inverse, 0.01F));
  if (far_m < kReliefEnd_m && eye_height_m > kHighest_m) {
    const float step = kHighest_m / down / kMarch;
    const int level =
        std::clamp(static_cast<int>(std::max(across, std::log2(step * 0.4F * inverse))),
                   0,
                   static_cast<int>(levels_.size()) - 2);
    float s = far_m - kHighest_m / down;
    float above = kHighest_m;
    for (int i = 0; i < kMarch; ++i) {
      const float next = s + step;
      const float ray_m = kHighest_m * static_cast<float>(kMarch - 1 - i) / kMarch;
      const float top_m = height_m(
          (eye_north_m + next * north) * inverse, (eye_east_m + next * east) * inverse, level);
      if (top_m > ray_m) {
        const float below = top_m - ray_m;
        t = s + step * above / (above + below);
        const float side = clamp01(below / (0.5F * kHighest_m));
        shade = 1 - 0.45F * side;
        break;
      }
      above = ray_m - top_m;
      s = next;
    }
  }
  const float north_m = eye_north_m + t * north;
  const float east_m = eye_east_m + t * east;
  const float along = std::min(-std::log2(std::max(down, 1e-4F)), 5.0F);
  const float x = north_m * inverse;
  const float y = east_m * inverse;
  // Two probes along the ray's foot: less blur than one wide one.
  const float half = 0.25F * t * pixel_rad_ / std::max(down, 0.01F) * inverse;
  const float level = across + 0.5F * along - 0.5F;
  const Light root = 0.5F * (colour(x - half * north, y - half * east, level) +
                             colour(x + half * north, y + half * east, level));
  Light albedo = root * root;
  if (t < 1200) albedo *= 1 + (1 - t / 1200) * (detail(north_m, east_m) - 0.5F) * 0.7F;
  const float lit = sunlit(north_m, east_m);
  const float fog = 1 - std::exp(-reach_m / kVisibility_m);
  const Light up = albedo * (sunlight_ * lit + skylight_) * shade;
  return up + (veil - up) * fog;
}

}  // namespace airtruth::synthetic
