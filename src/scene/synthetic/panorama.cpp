// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/panorama.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace airtruth::synthetic {
namespace {

// Two ranges of hills, as heights over the horizon by direction.
class HillRanges {
 public:
  HillRanges(const Panorama::Hills& hills, std::uint32_t seed)
      : highest_(static_cast<float>(radians(hills.highest_deg))),
        far_veil_(veil(30, hills.extinction_per_km)),
        near_veil_(veil(21.6, hills.extinction_per_km)),
        seed_(seed) {}

  void cover(const Vector3& direction, float texel_rad, const Sky& sky, LinearRgb& colour) const {
    const float up = static_cast<float>(-direction.z());
    if (highest_ <= 0 || up > highest_ * 1.05F) return;
    const float azimuth =
        static_cast<float>((std::atan2(direction.y(), direction.x()) / (2 * kPi) + 0.5) * 16);
    const LinearRgb haze = sky.haze(direction);
    const LinearRgb slope = linear_rgb(0.17F, 0.165F, 0.12F);
    range(azimuth, up, highest_, far_veil_, 1, texel_rad, haze, slope, colour);
    range(azimuth * 2, up, 0.55F * highest_, near_veil_, 2, texel_rad, haze, slope, colour);
  }

 private:
  // The share of airlight in the light of a range of hills at that distance.
  static float veil(double range_km, double extinction_per_km) {
    return static_cast<float>(1 - std::exp(-range_km * extinction_per_km));
  }

  void range(float azimuth,
             float up,
             float highest,
             float veil,
             std::uint32_t layer,
             float texel_rad,
             const LinearRgb& haze,
             const LinearRgb& slope,
             LinearRgb& colour) const {
    const int period = layer == 1 ? 16 : 32;
    const float shape = fractal(azimuth, 0.5F, 7, period, seed_ + 31 * layer);
    const float top = highest * clamp01(2.2F * (shape - 0.30F));
    const float covered = smoothstep(-0.7F * texel_rad, 0.7F * texel_rad, top - up);
    const float folds =
        0.8F + 0.5F * fractal(azimuth * 8, up / highest * 3, 3, period * 8, seed_ + 7);
    const LinearRgb hill = haze * veil + slope * folds * (1 - veil);
    colour += (hill - colour) * covered;
  }

  float highest_;
  float far_veil_;
  float near_veil_;
  std::uint32_t seed_;
};

// Places in the map.
struct Texels {
  alignas(64) Integers index;
  alignas(64) Floats right;
  alignas(64) Floats lower;
};

AIRTRUTH_FOR_VECTORS
void locate(const Rays& rays, float radius, float centre, int size, Texels& texels) {
  const int count = rays.count;
  for (int i = 0; i < count; ++i) {
    const float scale = radius / (1 - rays.down[i]);
    const float x = centre + rays.north[i] * scale;
    const float y = centre + rays.east[i] * scale;
    const auto ix = static_cast<std::int32_t>(x);
    const auto iy = static_cast<std::int32_t>(y);
    texels.index[i] = iy * size + ix;
    texels.right[i] = x - static_cast<float>(ix);
    texels.lower[i] = y - static_cast<float>(iy);
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
  const HillRanges ranges(hills, seed);
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
        ranges.cover(direction, texel_rad, sky, colour);
        texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) +
                static_cast<std::size_t>(x)] = colour;
      }
  });
}

void Panorama::seen(const Rays& rays, Light& light) const {
  Texels texels;
  locate(rays, radius_, centre_, size_, texels);
  for (int i = 0; i < rays.count; ++i) {
    const LinearRgb* p = &texels_[static_cast<std::size_t>(texels.index[i])];
    const LinearRgb upper = p[0] + (p[1] - p[0]) * texels.right[i];
    const LinearRgb lower = p[size_] + (p[size_ + 1] - p[size_]) * texels.right[i];
    const LinearRgb colour = upper + (lower - upper) * texels.lower[i];
    light.red[i] = colour[0];
    light.green[i] = colour[1];
    light.blue[i] = colour[2];
  }
}

}  // namespace airtruth::synthetic
