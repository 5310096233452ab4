// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/ground.h"

#include <algorithm>
#include <cmath>

namespace airtruth::synthetic {
namespace {

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Beyond this distance the ground is flat.
constexpr float kReliefEnd_m = 5000;
// Distance at which the hills begin.
constexpr float kFarthest_m = 26000;
// Side of a cell of Ground::detail_.
constexpr float kDetail_m = 0.4F;
// Distance up to which the ground has detail that is finer than its texels.
constexpr float kDetailEnd_m = 1200;
// The optical depth at which nothing of the light is left in single precision.
constexpr float kOpaque = 80;
// Number of steps through the height field; the range of near rays, and bisections of the step that
// meets the field, for near rays and for others.
constexpr int kMarch = 7;
constexpr float kNear_m = 600;
constexpr int kNearBisections = 4;
constexpr int kFarBisections = 2;

// A ray that points down: a unit vector, but that `down` is its mean fall towards the level ground,
// which curves away below it.
struct Ray {
  float north, east, down;
};

// Rays above the horizon are taken to it. With R the Earth's radius, s the sine of a ray below the
// horizontal and d that of the dip, d^2 = 2 h / R, the ray falls on the ground from the height h
// where h - s t + t^2 / 2 R = 0: at t = 2 h / (s + sqrt(s^2 - d^2)).
[[gnu::always_inline]] inline Ray ray_at(const Eye& eye, const Row::Run& pixels, int i) {
  const float down = std::max(pixels.down[i], eye.dip);
  const float fall = 0.5F * (down + std::sqrt(down * down - eye.dip * eye.dip));
  return {pixels.north[i], pixels.east[i], std::max(fall, 1e-5F)};
}

// Distance along the ray to the level ground.
[[gnu::always_inline]] inline float level_m(const Eye& eye, const Ray& ray) {
  return eye.height_m / ray.down;
}

// The ground's tile as the loops over rays read it.
struct View {
  const std::uint32_t* texels;
  const std::int32_t* first;
  const std::int32_t* wrap;
  const float* scale;
  int top;
  float texel_m;
  float per_texel;
  float pixel_rad;

  // Base-2 logarithm of the width, in texels, of a pixel that sees the level ground.
  [[gnu::always_inline]] float across(const Eye& eye, const Ray& ray) const {
    const float reach_m = std::min(level_m(eye, ray), kFarthest_m);
    return fast_log2(std::max(reach_m * pixel_rad * per_texel, 0.01F));
  }
};

View view_of(const Tile& tile, float pixel_rad) {
  return {tile.texels.data(),
          tile.first.data(),
          tile.wrap.data(),
          tile.scale.data(),
          tile.levels - 2,
          tile.texel_m,
          1 / tile.texel_m,
          pixel_rad};
}

// Rays that may meet a tree or a house before they reach the ground.
struct Search {
  using Floats = float[Row::kRun];
  using Integers = std::int32_t[Row::kRun];
  int count = 0;
  // Place of the ray in its run.
  alignas(64) Integers pixel;
  alignas(64) Floats north, east, down;
  // Distance to the level ground, and greatest height around.
  alignas(64) Floats far_m, peak_m;
  // The mip level.
  alignas(64) Integers first, wrap;
  alignas(64) Floats scale;
  // The ray is outside of everything at `clear_m`, and inside of something at `inside_m` once it
  // has met it; until then `inside_m` is negative.
  alignas(64) Floats step_m, clear_m, inside_m;
  // Factor of the shade where it met something.
  alignas(64) Floats shade;

  // The height at that distance along the ray, between the height bytes of four texels.
  [[gnu::always_inline]] float height_m(const View& tile, const Eye& eye, int i, float at_m) const {
    const float x = (eye.north_m + at_m * north[i]) * tile.per_texel;
    const float y = (eye.east_m + at_m * east[i]) * tile.per_texel;
    const Neighbours n = neighbours(x * scale[i] - 0.5F, y * scale[i] - 0.5F, first[i], wrap[i]);
    const std::uint32_t sum =
        weighted(tile.texels, n, [](std::uint32_t texel) { return texel >> 24; });
    return static_cast<float>(static_cast<std::int32_t>(sum)) * (Tile::kHighest_m / 65280);
  }
};

AIRTRUTH_FOR_VECTORS
void start(const View& given, const Eye& eye, const Row::Run& run, Search& __restrict search) {
  const View tile = given;
  const Row::Run pixels = run;
  const int count = search.count;
  for (int i = 0; i < count; ++i) {
    const Ray ray = ray_at(eye, pixels, search.pixel[i]);
    const float far_m = level_m(eye, ray);
    const float step_m = search.peak_m[i] / ray.down / kMarch;
    const float finest = std::max(tile.across(eye, ray), fast_log2(step_m * 0.4F * tile.per_texel));
    const std::int32_t level = std::clamp(static_cast<int>(finest), 0, tile.top);
    search.north[i] = ray.north;
    search.east[i] = ray.east;
    search.down[i] = ray.down;
    search.far_m[i] = far_m;
    search.first[i] = tile.first[level];
    search.wrap[i] = tile.wrap[level];
    search.scale[i] = tile.scale[level];
    search.step_m[i] = step_m;
    search.clear_m[i] = far_m - search.peak_m[i] / ray.down;
  }
}

// One step of every ray that has met nothing.
AIRTRUTH_FOR_VECTORS
void step(const View& given, const Eye& from, Search& __restrict s) {
  const View tile = given;
  const Eye eye = from;
  const int count = s.count;
  for (int i = 0; i < count; ++i) {
    const float at_m = s.clear_m[i] + s.step_m[i];
    const float x = (eye.north_m + at_m * s.north[i]) * tile.per_texel;
    const float y = (eye.east_m + at_m * s.east[i]) * tile.per_texel;
    const std::int32_t ix = floor_int(x * s.scale[i]) & s.wrap[i];
    const std::int32_t iy = floor_int(y * s.scale[i]) & s.wrap[i];
    const std::uint32_t texel =
        tile.texels[s.first[i] + index_of_row(iy, s.wrap[i]) + index_in_row(ix)];
    const float height_m =
        static_cast<float>(static_cast<std::int32_t>(texel >> 24)) * (Tile::kHighest_m / 255);
    const bool free = (s.far_m[i] - at_m) * s.down[i] >= height_m;
    s.clear_m[i] = free ? at_m : s.clear_m[i];
    s.inside_m[i] = free ? -1.0F : at_m;
  }
}

// Halves the interval of the rays that meet something and reach the ground before `end_m`.
AIRTRUTH_FOR_VECTORS
void bisect(const View& given, const Eye& from, float end_m, Search& __restrict s) {
  const View tile = given;
  const Eye eye = from;
  const int count = s.count;
  for (int i = 0; i < count; ++i) {
    const float middle_m = 0.5F * (s.clear_m[i] + s.inside_m[i]);
    const bool below = (s.far_m[i] - middle_m) * s.down[i] < s.height_m(tile, eye, i, middle_m);
    const bool wanted = (s.inside_m[i] >= 0) & (s.far_m[i] < end_m);
    s.inside_m[i] = (wanted & below) ? middle_m : s.inside_m[i];
    s.clear_m[i] = (wanted & !below) ? middle_m : s.clear_m[i];
  }
}

// Steep slopes are darker.
AIRTRUTH_FOR_VECTORS
void shade(const View& given, const Eye& from, Search& __restrict s) {
  const View tile = given;
  const Eye eye = from;
  const int count = s.count;
  for (int i = 0; i < count; ++i) {
    const float ray_m = (s.far_m[i] - s.inside_m[i]) * s.down[i];
    const float top_m = s.height_m(tile, eye, i, s.inside_m[i] + 0.8F * tile.texel_m);
    s.shade[i] = 1 - 0.5F * clamp01((top_m - ray_m) / (0.6F * s.peak_m[i]));
  }
}

// Traces rays through the height field in a few equal steps, and bisects the step on which they
// meet it (relief mapping; Policarpo, Oliveira and Comba 2005).
void meet(const View& tile, const Eye& eye, const Row::Run& pixels, Search& search) {
  if (search.count == 0) return;
  start(tile, eye, pixels, search);
  for (int k = 0; k < kMarch; ++k) step(tile, eye, search);
  for (int k = 0; k < kFarBisections; ++k) bisect(tile, eye, kReliefEnd_m, search);
  if (*std::min_element(search.far_m, search.far_m + search.count) < kNear_m)
    for (int k = kFarBisections; k < kNearBisections; ++k) bisect(tile, eye, kNear_m, search);
  shade(tile, eye, search);
}

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

// Square roots of red, green and blue of one mip level, 0 to 65280. The place is in texels of level
// 0.
struct Roots {
  float red, green, blue;
};

[[gnu::always_inline]] inline Roots roots(const View& tile, float x, float y, std::int32_t level) {
  const float scale = tile.scale[level];
  const Neighbours n =
      neighbours(x * scale - 0.5F, y * scale - 0.5F, tile.first[level], tile.wrap[level]);
  const std::uint32_t red_blue =
      weighted(tile.texels, n, [](std::uint32_t texel) { return texel & 0x00FF00FFU; });
  const std::uint32_t green =
      weighted(tile.texels, n, [](std::uint32_t texel) { return (texel >> 8) & 0xFFU; });
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
  [[gnu::always_inline]] float seen(
      float root, float grain, float lit, float shade, int sector, float part, float fog) const {
    const float light = root * root * grain * (sunlight * lit + skylight) * shade;
    const float veil = haze[sector] + (haze[sector + 1] - haze[sector]) * part;
    return light + (veil - light) * fog;
  }
};

}  // namespace

// What the rays of a run meet, and the light from there.
struct Ground::Seen {
  using Floats = float[Row::kRun];
  // Cell of greatest heights.
  alignas(64) std::int32_t cell[Row::kRun];
  // Distance along the ray, and factor of the shade of trees and houses.
  alignas(64) Floats distance_m, shade;
  // The sector of the haze, by the angle to the sun, and the share of the next one.
  alignas(64) std::int32_t sector[Row::kRun];
  alignas(64) Floats sector_part;
  alignas(64) Floats red, green, blue;
};

// The cells of greatest heights around the last part of each ray, and its place in the haze.
AIRTRUTH_FOR_VECTORS
void Ground::look_up(const Eye& from, const Row::Run& run, Seen& __restrict seen) const {
  const Eye eye = from;
  const Row::Run pixels = run;
  const std::int32_t* first = tile_.first_peak.data();
  const auto sun_north = static_cast<float>(sun_.x());
  const auto sun_east = static_cast<float>(sun_.y());
  for (int i = 0; i < pixels.count; ++i) {
    const Ray ray = ray_at(eye, pixels, i);
    const float span_m = Tile::kHighest_m / ray.down;
    const float middle_m = level_m(eye, ray) - 0.5F * span_m;
    std::int32_t level = 0;
    float cell_m = Tile::kPeakCell_m;
    for (int k = 1; k < Tile::kPeakLevels; ++k) {
      const bool wider = 2 * cell_m < span_m;
      cell_m = wider ? 2 * cell_m : cell_m;
      level += wider ? 1 : 0;
    }
    const int side = static_cast<int>(kLand_m / cell_m);
    const int x = floor_int((eye.north_m + middle_m * ray.north) / cell_m) & (side - 1);
    const int y = floor_int((eye.east_m + middle_m * ray.east) / cell_m) & (side - 1);
    seen.cell[i] = first[level] + y * side + x;
    const float cosine = std::clamp(ray.north * sun_north + ray.east * sun_east, -1.0F, 1.0F);
    const float at = (cosine * 0.5F + 0.5F) * (kHazeSectors - 1.001F);
    seen.sector[i] = static_cast<std::int32_t>(at);
    seen.sector_part[i] = at - static_cast<float>(seen.sector[i]);
  }
}

// The square roots of the ground's colour, between two mip levels.
AIRTRUTH_FOR_VECTORS
void Ground::colour(const Eye& from, const Row::Run& run, Seen& __restrict seen) const {
  const Eye eye = from;
  const Row::Run pixels = run;
  const View tile = view_of(tile_, pixel_rad_);
  for (int i = 0; i < pixels.count; ++i) {
    const Ray ray = ray_at(eye, pixels, i);
    const float along = std::min(-fast_log2(std::max(ray.down, 1e-4F)), 5.0F);
    const float level =
        std::clamp(tile.across(eye, ray) + 0.5F * along - 0.6F, 0.0F, static_cast<float>(tile.top));
    const std::int32_t finer = std::min(static_cast<int>(level), tile.top - 1);
    const float coarser = level - static_cast<float>(finer);
    const float x = (eye.north_m + seen.distance_m[i] * ray.north) * tile.per_texel;
    const float y = (eye.east_m + seen.distance_m[i] * ray.east) * tile.per_texel;
    const Roots fine = roots(tile, x, y, finer);
    const Roots coarse = roots(tile, x, y, finer + 1);
    // The weights of four texels sum to 256, and the largest root of a colour is 255.
    constexpr float kUnit = 1.0F / (256 * 255);
    seen.red[i] = lerp(fine.red, coarse.red, coarser) * kUnit;
    seen.green[i] = lerp(fine.green, coarse.green, coarser) * kUnit;
    seen.blue[i] = lerp(fine.blue, coarse.blue, coarser) * kUnit;
  }
}

// The light of that colour through the haze.
AIRTRUTH_FOR_VECTORS
void Ground::shine(const Eye& from, const Row::Run& run, Seen& __restrict seen) const {
  const Eye eye = from;
  const Row::Run pixels = run;
  const float* shadow = shadow_.data();
  const float* detail = detail_.data();
  const float per_shadow = kShadowCells / static_cast<float>(Clouds::period_m());
  const float extinction_per_m = extinction_per_m_;
  const Colour red{haze_[0].data(), sunlight_[0], skylight_[0]};
  const Colour green{haze_[1].data(), sunlight_[1], skylight_[1]};
  const Colour blue{haze_[2].data(), sunlight_[2], skylight_[2]};
  for (int i = 0; i < pixels.count; ++i) {
    const Ray ray = ray_at(eye, pixels, i);
    const float north_m = eye.north_m + seen.distance_m[i] * ray.north;
    const float east_m = eye.east_m + seen.distance_m[i] * ray.east;
    const float mottle =
        interpolated(detail, kDetailCells, north_m / kDetail_m, east_m / kDetail_m);
    const float near = std::max(1 - seen.distance_m[i] / kDetailEnd_m, 0.0F);
    const float grain = 1 + near * (mottle - 0.5F) * 0.7F;
    const float lit = interpolated(shadow, kShadowCells, north_m * per_shadow, east_m * per_shadow);
    const std::int32_t sector = seen.sector[i];
    const float part = seen.sector_part[i];
    const float reach_m = std::min(level_m(eye, ray), kFarthest_m);
    const float fog = 1 - exp_of_negative(std::max(-reach_m * extinction_per_m, -kOpaque));
    const float shade = seen.shade[i];
    seen.red[i] = red.seen(seen.red[i], grain, lit, shade, sector, part, fog);
    seen.green[i] = green.seen(seen.green[i], grain, lit, shade, sector, part, fog);
    seen.blue[i] = blue.seen(seen.blue[i], grain, lit, shade, sector, part, fog);
  }
}

void Ground::light(const Eye& eye, const Row::Run& pixels) const {
  Seen seen;
  look_up(eye, pixels, seen);
  Search search;
  for (int i = 0; i < pixels.count; ++i) {
    const float far_m = level_m(eye, ray_at(eye, pixels, i));
    const std::uint8_t peak = tile_.peaks[static_cast<std::size_t>(seen.cell[i])];
    seen.distance_m[i] = std::min(far_m, kFarthest_m);
    seen.shade[i] = 1;
    search.pixel[search.count] = i;
    search.peak_m[search.count] = static_cast<float>(peak) * (Tile::kHighest_m / 255);
    search.count +=
        ((peak != 0) & (far_m < kReliefEnd_m) & (eye.height_m > Tile::kHighest_m)) ? 1 : 0;
  }
  meet(view_of(tile_, pixel_rad_), eye, pixels, search);
  for (int k = 0; k < search.count; ++k) {
    if (search.inside_m[k] < 0) continue;
    seen.distance_m[search.pixel[k]] = search.inside_m[k];
    seen.shade[search.pixel[k]] = search.shade[k];
  }
  colour(eye, pixels, seen);
  shine(eye, pixels, seen);
  std::copy_n(seen.red, pixels.count, pixels.red);
  std::copy_n(seen.green, pixels.count, pixels.green);
  std::copy_n(seen.blue, pixels.count, pixels.blue);
}

Ground::Ground(double texel_m,
               double pixel_rad,
               double extinction_per_km,
               const Sky& sky,
               const Clouds& clouds,
               std::uint32_t seed)
    : pixel_rad_(static_cast<float>(pixel_rad)),
      extinction_per_m_(static_cast<float>(extinction_per_km / 1000)),
      sun_(sky.sun_in_world()),
      sunlight_(sky.sunlight() * (0.25F + 0.9F * static_cast<float>(std::max(-sun_.z(), 0.1)))),
      tile_(texel_m, sun_, seed),
      shadow_(clouds.ground_shadow(kShadowCells)),
      detail_(std::size_t{kDetailCells} * kDetailCells) {
  make_haze(sky);
  auto detail = fractal<4>(kDetailCells / 16, seed + 41);
  for (int y = 0; y < kDetailCells; ++y)
    for (int x = 0; x < kDetailCells; ++x)
      detail_[static_cast<std::size_t>(y * kDetailCells + x)] =
          detail.at(static_cast<float>(x) / 16, static_cast<float>(y) / 16);
}

void Ground::make_haze(const Sky& sky) {
  const Vector3 level_sun = Vector3(sun_.x(), sun_.y(), 0).normalized();
  const double level = std::hypot(sun_.x(), sun_.y());
  const Vector3 side(-level_sun.y(), level_sun.x(), 0);
  for (int i = 0; i < kHazeSectors; ++i) {
    const double cosine =
        std::clamp((2.0 * i / (kHazeSectors - 1) - 1) / std::max(level, 1e-6), -1.0, 1.0);
    const LinearRgb haze = sky.haze(cosine * level_sun + std::sqrt(1 - cosine * cosine) * side);
    for (int c = 0; c < 3; ++c)
      haze_[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] = haze[c];
  }
}

}  // namespace airtruth::synthetic
