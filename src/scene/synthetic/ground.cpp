// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/ground.h"

#include <algorithm>
#include <cmath>

namespace airtruth::synthetic {
namespace {

// Beyond this distance the ground is flat.
constexpr float kReliefEnd_m = 5000;
// Distance at which the hills begin.
constexpr float kFarthest_m = 26000;
constexpr float kPeakCell_m = 10;
constexpr float kDetail_m = 0.4F;
// Distance up to which the ground has detail that is finer than its texels.
constexpr float kDetailEnd_m = 1200;
// The optical depth at which nothing of the light is left in single precision.
constexpr float kOpaque = 80;

// Bilinear interpolation in a square table that repeats.
[[gnu::always_inline]] inline float interpolated(const float* table, int cells, float x, float y) {
  const int ix = floor_int(x);
  const int iy = floor_int(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const int wrap = cells - 1;
  const int upper = (iy & wrap) * cells;
  const int lower = ((iy + 1) & wrap) * cells;
  const int left = ix & wrap;
  const int right = (ix + 1) & wrap;
  return lerp(lerp(table[upper + left], table[upper + right], fx),
              lerp(table[lower + left], table[lower + right], fx),
              fy);
}

// Square roots of red, green and blue of one mip level, 0 to 65280.
struct Roots {
  float red, green, blue;
};

[[gnu::always_inline]] inline Roots roots(
    const std::uint32_t* texels, float x, float y, std::int32_t first, std::int32_t wrap) {
  const Neighbours n = neighbours(x, y, first, wrap);
  const std::uint32_t red_blue =
      weighted(texels, n, [](std::uint32_t texel) { return texel & 0x00FF00FFU; });
  const std::uint32_t green =
      weighted(texels, n, [](std::uint32_t texel) { return (texel >> 8) & 0xFFU; });
  const auto real = [](std::uint32_t sum) {
    return static_cast<float>(static_cast<std::int32_t>(sum));
  };
  return {real(red_blue & 0xFFFFU), real(green), real(red_blue >> 16)};
}

// Light of the ground through the air, of one colour.
struct Colour {
  const float* haze;
  float sunlight;
  float skylight;
  [[gnu::always_inline]] float seen(float root, float grain, float lit, float shade) const {
    return root * root * grain * (sunlight * lit + skylight) * shade;
  }
  [[gnu::always_inline]] float veiled(float light, int sector, float part, float fog) const {
    const float veil = haze[sector] + (haze[sector + 1] - haze[sector]) * part;
    return light + (veil - light) * fog;
  }
};

// Copies the rays that the search names.
AIRTRUTH_FOR_VECTORS
void select_rays(const Rays& rays,
                 const Floats& far_m,
                 const Floats& across,
                 const Floats& peak_m,
                 Search& __restrict search) {
  const int count = search.count;
  select(rays.north, search.ray, count, search.north);
  select(rays.east, search.ray, count, search.east);
  select(rays.down, search.ray, count, search.down);
  select(far_m, search.ray, count, search.far_m);
  select(across, search.ray, count, search.across);
  select(peak_m, search.ray, count, search.peak_m);
}

}  // namespace

// The distance to the level ground, and the cell of greatest heights around the ray's last part.
AIRTRUTH_FOR_VECTORS
void Ground::reach(const Eye& eye, const Rays& rays, Points& __restrict points) const {
  const int count = rays.count;
  const std::int32_t* first = first_peak_.data();
  const float per_texel = 1 / texel_m_;
  const float pixel_rad = pixel_rad_;
  for (int i = 0; i < count; ++i) {
    const float far_m = eye.height_m / std::max(rays.down[i], 1e-5F);
    const float reach_m = std::min(far_m, kFarthest_m);
    points.far_m[i] = far_m;
    points.reach_m[i] = reach_m;
    points.distance_m[i] = reach_m;
    points.shade[i] = 1;
    points.across[i] = fast_log2(std::max(reach_m * pixel_rad * per_texel, 0.01F));
    const float span_m = kHighest_m / rays.down[i];
    const float middle_m = far_m - 0.5F * span_m;
    std::int32_t level = 0;
    float cell_m = kPeakCell_m;
    for (int k = 1; k < kPeakLevels; ++k) {
      const bool wider = 2 * cell_m < span_m;
      cell_m = wider ? 2 * cell_m : cell_m;
      level += wider ? 1 : 0;
    }
    const int cells = static_cast<int>(kLand_m / cell_m);
    const int x = floor_int((eye.north_m + middle_m * rays.north[i]) / cell_m) & (cells - 1);
    const int y = floor_int((eye.east_m + middle_m * rays.east[i]) / cell_m) & (cells - 1);
    points.level[i] = level;
    points.cell[i] = y * cells + x;
  }
  for (int i = 0; i < count; ++i) points.cell[i] += first[points.level[i]];
}

void Ground::meet(const Eye& eye, const Rays& rays, Points& points) const {
  Search search;
  alignas(64) Floats peak_m;
  for (int i = 0; i < rays.count; ++i) {
    const std::uint8_t peak = peaks_[static_cast<std::size_t>(points.cell[i])];
    peak_m[i] = static_cast<float>(peak) * (kHighest_m / 255);
    search.ray[search.count] = i;
    search.count += ((peak != 0) & (points.far_m[i] < kReliefEnd_m)) ? 1 : 0;
  }
  if (search.count == 0) return;
  select_rays(rays, points.far_m, points.across, peak_m, search);
  synthetic::meet({&map_, texel_m_, kHighest_m}, eye, search);
  for (int k = 0; k < search.count; ++k) {
    if (search.distance_m[k] < 0) continue;
    points.distance_m[search.ray[k]] = search.distance_m[k];
    points.shade[search.ray[k]] = search.shade[k];
  }
}

// Where the tables are read: the mip level and the sector of the haze.
AIRTRUTH_FOR_VECTORS
void Ground::look_up(const Eye& eye, const Rays& rays, Points& __restrict points) const {
  const int count = rays.count;
  const int top = map_.levels - 2;
  const float extinction_per_m = extinction_per_m_;
  const auto sun_north = static_cast<float>(sun_.x());
  const auto sun_east = static_cast<float>(sun_.y());
  for (int i = 0; i < count; ++i) {
    const float along = std::min(-fast_log2(std::max(rays.down[i], 1e-4F)), 5.0F);
    const float level =
        std::clamp(points.across[i] + 0.5F * along - 0.6F, 0.0F, static_cast<float>(top));
    points.level[i] = std::min(static_cast<int>(level), top - 1);
    points.level_part[i] = level - static_cast<float>(points.level[i]);
    const float cosine =
        std::clamp(rays.north[i] * sun_north + rays.east[i] * sun_east, -1.0F, 1.0F);
    const float at = (cosine * 0.5F + 0.5F) * (kHazeSectors - 1.001F);
    points.sector[i] = static_cast<int>(at);
    points.sector_part[i] = at - static_cast<float>(points.sector[i]);
    points.fog[i] = 1 - exp_of_negative(std::max(-points.reach_m[i] * extinction_per_m, -kOpaque));
    points.north_m[i] = eye.north_m + points.distance_m[i] * rays.north[i];
    points.east_m[i] = eye.east_m + points.distance_m[i] * rays.east[i];
  }
}

// The square roots of the ground's colour.
AIRTRUTH_FOR_VECTORS
void Ground::colour(const Points& points, int count, Light& __restrict light) const {
  const std::uint32_t* texels = map_.texels.data();
  const std::int32_t* first = map_.first.data();
  const std::int32_t* wrap = map_.wrap.data();
  const float* scale = map_.scale.data();
  const float per_texel = 1 / texel_m_;
  for (int i = 0; i < count; ++i) {
    const std::int32_t level = points.level[i];
    const float x = points.north_m[i] * per_texel;
    const float y = points.east_m[i] * per_texel;
    const Roots fine =
        roots(texels, x * scale[level] - 0.5F, y * scale[level] - 0.5F, first[level], wrap[level]);
    const Roots coarse = roots(texels,
                               x * scale[level + 1] - 0.5F,
                               y * scale[level + 1] - 0.5F,
                               first[level + 1],
                               wrap[level + 1]);
    constexpr float kUnit = 1.0F / (256 * 255);
    light.red[i] = lerp(fine.red, coarse.red, points.level_part[i]) * kUnit;
    light.green[i] = lerp(fine.green, coarse.green, points.level_part[i]) * kUnit;
    light.blue[i] = lerp(fine.blue, coarse.blue, points.level_part[i]) * kUnit;
  }
}

AIRTRUTH_FOR_VECTORS
void Ground::shine(const Points& points, int count, Light& __restrict light) const {
  const float* shadow = shadow_.data();
  const float* detail = detail_.data();
  const float per_shadow = kShadowCells / static_cast<float>(Clouds::period_m());
  const Colour red{haze_[0].data(), sunlight_[0], skylight_[0]};
  const Colour green{haze_[1].data(), sunlight_[1], skylight_[1]};
  const Colour blue{haze_[2].data(), sunlight_[2], skylight_[2]};
  for (int i = 0; i < count; ++i) {
    const float north_m = points.north_m[i];
    const float east_m = points.east_m[i];
    const float mottle =
        interpolated(detail, kDetailCells, north_m / kDetail_m, east_m / kDetail_m);
    const float near = std::max(1 - points.distance_m[i] / kDetailEnd_m, 0.0F);
    const float grain = 1 + near * (mottle - 0.5F) * 0.7F;
    const float lit = interpolated(shadow, kShadowCells, north_m * per_shadow, east_m * per_shadow);
    const float shade = points.shade[i];
    const float fog = points.fog[i];
    const std::int32_t sector = points.sector[i];
    const float part = points.sector_part[i];
    light.red[i] = red.veiled(red.seen(light.red[i], grain, lit, shade), sector, part, fog);
    light.green[i] = green.veiled(green.seen(light.green[i], grain, lit, shade), sector, part, fog);
    light.blue[i] = blue.veiled(blue.seen(light.blue[i], grain, lit, shade), sector, part, fog);
  }
}

void Ground::seen(const Eye& eye, const Rays& rays, Light& light) const {
  Points points;
  reach(eye, rays, points);
  if (eye.height_m > kHighest_m) meet(eye, rays, points);
  look_up(eye, rays, points);
  colour(points, rays.count, light);
  shine(points, rays.count, light);
}

}  // namespace airtruth::synthetic
