// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/ground.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace airtruth::synthetic {
namespace {

// Beyond this distance the ground is flat.
constexpr float kReliefEnd_m = 5000;
// Distance at which the hills begin.
constexpr float kFarthest_m = 26000;
constexpr float kDetail_m = 0.4F;
// Distance up to which the ground has detail that is finer than its texels.
constexpr float kDetailEnd_m = 1200;
constexpr int kDetailCells = 256;
constexpr int kHazeSectors = 64;

// Base-2 logarithm of a positive number with an error below 0.09, which suffices to choose a mip
// level.
float fast_log2(float x) {
  return static_cast<float>(std::bit_cast<std::int32_t>(x)) * 0x1p-23F - 126.94F;
}

std::vector<LinearRgb> haze_of(const Sky& sky) {
  const Vector3& sun = sky.sun_in_world();
  const double level = std::max(std::hypot(sun.x(), sun.y()), 1e-6);
  const Vector3 ahead = Vector3(sun.x(), sun.y(), 0).normalized();
  const Vector3 side(-ahead.y(), ahead.x(), 0);
  std::vector<LinearRgb> haze;
  for (int i = 0; i < kHazeSectors; ++i) {
    const double cosine = std::clamp((2.0 * i / (kHazeSectors - 1) - 1) / level, -1.0, 1.0);
    haze.push_back(sky.haze(cosine * ahead + std::sqrt(1 - cosine * cosine) * side));
  }
  return haze;
}

}  // namespace

Ground::Ground(double altitude_m,
               double pixel_rad,
               double extinction_per_km,
               const Sky& sky,
               const Clouds& clouds,
               std::uint32_t seed)
    : pixel_rad_(static_cast<float>(pixel_rad)),
      extinction_per_m_(static_cast<float>(extinction_per_km / 1000)),
      sun_(sky.sun_in_world()),
      sunlight_(sky.sunlight() * (0.25F + 0.9F * static_cast<float>(std::max(-sun_.z(), 0.1)))),
      skylight_(linear_rgb(0.20F, 0.25F, 0.33F)),
      tile_(4 * altitude_m * pixel_rad, sun_, seed),
      shadow_(clouds.ground_shadow()),
      detail_(kDetailCells),
      haze_(haze_of(sky)) {
  for (int y = 0; y < kDetailCells; ++y)
    for (int x = 0; x < kDetailCells; ++x)
      detail_.at(x, y) = fractal(
          static_cast<float>(x) / 16, static_cast<float>(y) / 16, 4, kDetailCells / 16, seed + 41);
}

// Traces the ray through the height field in a few equal steps, and bisects the step on which it
// meets the field (relief mapping; Policarpo, Oliveira and Comba 2005).
Ground::Hit Ground::meet(const Eye& eye, const Ray& ray, float across) const {
  constexpr int kSteps = 10;
  constexpr int kBisections = 3;
  const float far_m = eye.height_m / ray[2];
  Hit hit{std::min(far_m, kFarthest_m), 1};
  if (eye.height_m <= GroundTile::kHighest_m || far_m > kReliefEnd_m) return hit;
  const float span_m = GroundTile::kHighest_m / ray[2];
  const float middle_m = far_m - 0.5F * span_m;
  const float peak_m =
      span_m > 2 * GroundTile::kPeakReach_m
          ? GroundTile::kHighest_m
          : tile_.peak_m(eye.north_m + middle_m * ray[0], eye.east_m + middle_m * ray[1]);
  if (peak_m <= 0) return hit;
  const float step_m = peak_m / ray[2] / kSteps;
  const float wide = fast_log2(step_m * 0.4F / tile_.texel_m());
  const int level = std::clamp(static_cast<int>(std::max(across, wide)), 0, tile_.last_level());
  const auto smooth_height_m = [&](float s) {
    return tile_.at(level, eye.north_m + s * ray[0], eye.east_m + s * ray[1])[3] *
           GroundTile::kHighest_m;
  };
  float clear_m = far_m - peak_m / ray[2];
  float inside_m = clear_m;
  const auto inside = [&](float height_m) { return (far_m - inside_m) * ray[2] < height_m; };
  for (int i = 0; i < kSteps; ++i) {
    inside_m = clear_m + step_m;
    if (inside(
            tile_.height_m(level, eye.north_m + inside_m * ray[0], eye.east_m + inside_m * ray[1])))
      break;
    clear_m = inside_m;
  }
  if (clear_m == inside_m) return hit;
  for (int i = 0; i < kBisections; ++i) {
    const float s = 0.5F * (clear_m + inside_m);
    ((far_m - s) * ray[2] < smooth_height_m(s) ? inside_m : clear_m) = s;
  }
  // Steep slopes are darker.
  const float rise_m =
      smooth_height_m(inside_m + 0.8F * tile_.texel_m()) - (far_m - inside_m) * ray[2];
  return {inside_m, 1 - 0.5F * clamp01(rise_m / (0.6F * peak_m))};
}

// The light that leaves the ground.
LinearRgb Ground::lit(const Hit& hit, const Eye& eye, const Ray& ray, float level) const {
  const float north_m = eye.north_m + hit.distance_m * ray[0];
  const float east_m = eye.east_m + hit.distance_m * ray[1];
  const int whole = std::min(static_cast<int>(level), tile_.last_level() - 1);
  const float part = level - static_cast<float>(whole);
  const LinearRgb roots =
      tile_.at(whole, north_m, east_m) * (1 - part) + tile_.at(whole + 1, north_m, east_m) * part;
  const float near = std::max(1 - hit.distance_m / kDetailEnd_m, 0.0F);
  const float grain =
      near > 0 ? 1 + near * (detail_.between(north_m / kDetail_m, east_m / kDetail_m) - 0.5F) * 0.7F
               : 1.0F;
  const float per_m = static_cast<float>(shadow_.size() / Clouds::kPeriod_m);
  const float sun = shadow_.between(north_m * per_m, east_m * per_m);
  return roots * roots * (sunlight_ * sun + skylight_) * (grain * hit.shade);
}

LinearRgb Ground::haze(const Ray& ray) const {
  const float cosine = std::clamp(
      ray[0] * static_cast<float>(sun_.x()) + ray[1] * static_cast<float>(sun_.y()), -1.0F, 1.0F);
  const float at = (cosine * 0.5F + 0.5F) * (kHazeSectors - 1.001F);
  const auto sector = static_cast<std::size_t>(at);
  return haze_[sector] + (haze_[sector + 1] - haze_[sector]) * (at - static_cast<float>(sector));
}

LinearRgb Ground::seen(const Eye& eye, const Ray& ray) const {
  const float reach_m = std::min(eye.height_m / ray[2], kFarthest_m);
  const float across = fast_log2(std::max(reach_m * pixel_rad_ / tile_.texel_m(), 0.01F));
  const float along = std::min(-fast_log2(std::max(ray[2], 1e-4F)), 5.0F);
  const float level =
      std::clamp(across + 0.5F * along - 0.6F, 0.0F, static_cast<float>(tile_.last_level()));
  const LinearRgb light = lit(meet(eye, ray, across), eye, ray, level);
  return light + (haze(ray) - light) * (1 - std::exp(-reach_m * extinction_per_m_));
}

}  // namespace airtruth::synthetic
