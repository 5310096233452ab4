// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/panorama.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace airtruth::synthetic {
namespace {

// Covers the sky with two ranges of hills, whose heights over the horizon depend on the direction.
void cover(const Vector3& direction,
           const Panorama::Hills& hills,
           float texel_rad,
           const Sky& sky,
           std::uint32_t seed,
           LinearRgb& colour) {
  const auto highest = static_cast<float>(radians(hills.highest_deg));
  const float up = static_cast<float>(-direction.z());
  if (highest <= 0 || up > highest * 1.05F) return;
  const float turn =
      static_cast<float>((std::atan2(direction.y(), direction.x()) / (2 * kPi) + 0.5) * 16);
  const LinearRgb haze = sky.haze(direction);
  const LinearRgb slope = linear_rgb(0.17F, 0.165F, 0.12F);
  struct Range {
    int layer;
    float height;
    double distance_km;
  };
  for (const Range& range : {Range{1, highest, 30}, Range{2, 0.55F * highest, 21.6}}) {
    const float azimuth = turn * static_cast<float>(range.layer);
    const int period = 16 * range.layer;
    const float shape =
        fractal(azimuth, 0.5F, 7, period, seed + 31 * static_cast<std::uint32_t>(range.layer));
    const float top = range.height * clamp01(2.2F * (shape - 0.30F));
    const float covered = smoothstep(-0.7F * texel_rad, 0.7F * texel_rad, top - up);
    const float folds =
        0.8F + 0.5F * fractal(azimuth * 8, up / range.height * 3, 3, period * 8, seed + 7);
    // The share of airlight in the light of the hills.
    const auto veil =
        static_cast<float>(1 - std::exp(-range.distance_km * hills.extinction_per_km));
    const LinearRgb hill = haze * veil + slope * folds * (1 - veil);
    colour += (hill - colour) * covered;
  }
}

}  // namespace

Panorama::Panorama(double texel_rad) : radius_(static_cast<float>(1 / texel_rad)) {
  const float edge = radius_ * 1.03F + 4;
  blocks_ = static_cast<int>(2 * edge) / kBlock + 1;
  size_ = blocks_ * kBlock;
  centre_ = 0.5F * static_cast<float>(size_);
  texels_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_),
                 LinearRgb::Zero());
  wanted_.assign(static_cast<std::size_t>(blocks_) * static_cast<std::size_t>(blocks_), 0);
}

void Panorama::want(float north, float east, float up) {
  if (up < kLowest) return;
  const float scale = radius_ / (1 + up);
  const int x = static_cast<int>(centre_ + north * scale) / kBlock;
  const int y = static_cast<int>(centre_ + east * scale) / kBlock;
  for (int j = std::max(y - 2, 0); j <= std::min(y + 2, blocks_ - 1); ++j)
    for (int i = std::max(x - 2, 0); i <= std::min(x + 2, blocks_ - 1); ++i)
      wanted_[static_cast<std::size_t>(j * blocks_ + i)] = 1;
}

void Panorama::draw(const Sky& sky, const Clouds& clouds, const Hills& hills, std::uint32_t seed) {
  const float texel_rad = 1 / radius_;
  tbb::parallel_for(0, blocks_ * blocks_, [&](int block) {
    if (wanted_[static_cast<std::size_t>(block)] == 0) return;
    const int left = block % blocks_ * kBlock;
    const int top = block / blocks_ * kBlock;
    for (int y = top; y < top + kBlock; ++y)
      for (int x = left; x < left + kBlock; ++x) {
        const double u = (static_cast<float>(x) - centre_) / radius_;
        const double v = (static_cast<float>(y) - centre_) / radius_;
        const double square = u * u + v * v;
        const double up = (1 - square) / (1 + square);
        const Vector3 direction(u * (1 + up), v * (1 + up), -up);
        LinearRgb colour = clouds.seen_through(direction, sky.at(direction));
        cover(direction, hills, texel_rad, sky, seed, colour);
        texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                static_cast<std::size_t>(x)] = colour;
      }
  });
}

}  // namespace airtruth::synthetic
