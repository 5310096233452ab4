// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/sky.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "foundation/geometry/box.h"

namespace airtruth::synthetic {

Sky::Sky(const Vector3& sun_in_world) : sun_(sun_in_world) {
  // A low sun is redder and weaker.
  const float up = static_cast<float>(std::max(-sun_.z(), 0.02));
  const float air = 1 / (up + 0.05F);
  sunlight_ =
      1.12F * linear_rgb(std::exp(-0.03F * air), std::exp(-0.055F * air), std::exp(-0.11F * air));
}

LinearRgb Sky::at(const Vector3& direction) const {
  const float up = static_cast<float>(std::max(-direction.z(), 0.0));
  const float cosine = static_cast<float>(std::clamp(direction.dot(sun_), -1.0, 1.0));
  const LinearRgb zenith = linear_rgb(0.075F, 0.175F, 0.42F);
  const LinearRgb middle = linear_rgb(0.20F, 0.37F, 0.66F);
  const LinearRgb horizon = linear_rgb(0.60F, 0.70F, 0.80F);
  const float near_horizon = std::exp(-11 * up);
  const float low = std::exp(-2.6F * up);
  const float day = std::clamp(static_cast<float>(-sun_.z()) * 2.5F + 0.25F, 0.1F, 1.0F);
  LinearRgb sum = zenith + (middle - zenith) * low + (horizon - middle) * near_horizon;
  sum *= day * (0.86F + 0.22F * cosine * cosine);
  const float toward = std::max(cosine, 0.0F);
  const float glow = 0.10F * std::pow(toward, 6.0F) + 0.28F * std::pow(toward, 48.0F) +
                     1.1F * std::pow(toward, 700.0F) +
                     8.0F * smoothstep(0.99996F, 0.99999F, cosine);
  return sum + sunlight_ * glow;
}

LinearRgb Sky::haze(const Vector3& direction) const {
  Vector3 level(direction.x(), direction.y(), 0);
  level.normalize();
  return 0.97F * at(level);
}

namespace {

// Where a constant of this file states no origin, it is a choice: the world is invented.

// Numbers of cells along north and along east.
constexpr int kCells = 512;
// Number of levels upwards.
constexpr int kLevels = 26;
// Side of a cell, height of the base of the clouds, their depth, and that of a level.
constexpr float kCell_m = 40;
constexpr float kBase_m = 1050;
constexpr float kDepth_m = 1500;
constexpr float kLevel_m = kDepth_m / kLevels;
// Number of texels of the fine noise along each axis, and the side of one.
constexpr int kDetail = 64;
constexpr float kDetailTexel_m = 15;
// Extinction within a cloud, the end of rays, the distance from which haze leaves 1/e of the light
// of clouds, and the height of the cirrus.
constexpr float kExtinction_per_m = 0.022F;
constexpr float kFarthestCloud_m = 60000;
constexpr float kHaze_m = 30000;
constexpr float kCirrus_m = 8500;

std::size_t voxel_index(int x, int y, int level) {
  return (static_cast<std::size_t>(y & (kCells - 1)) * kCells +
          static_cast<std::size_t>(x & (kCells - 1))) *
             kLevels +
         static_cast<std::size_t>(level);
}

// Phase function of Henyey and Greenstein (1941): a forward lobe plus an isotropic part.
float cloud_phase(float cosine) {
  const float g = 0.6F;
  const float lobe = (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5F);
  return 0.80F + 0.20F * lobe;
}

}  // namespace

double Clouds::period_m() { return double{kCells} * kCell_m; }

Clouds::Clouds(const Sky& sky, double cover, std::uint32_t seed)
    : sky_(sky),
      seed_(seed),
      cover_(cover),
      voxels_(std::size_t{kCells} * kCells * kLevels),
      column_used_(std::size_t{kCells} * kCells, 0),
      detail_(std::size_t{kDetail} * kDetail * kDetail) {
  if (cover <= 0) return;
  tbb::parallel_for(0, kDetail, [&](int z) {
    const float scale = 8.0F / kDetail;
    const auto f = [&](int i) { return static_cast<float>(i) * scale; };
    auto noise = fractal<3>(f(z), 8, seed_ + 5);
    for (int y = 0; y < kDetail; ++y)
      for (int x = 0; x < kDetail; ++x)
        detail_[static_cast<std::size_t>((z * kDetail + y) * kDetail + x)] = noise.at(f(x), f(y));
  });
  fill(cover);
  light_up();
}

void Clouds::fill(double cover) {
  const float threshold = lerp(0.72F, 0.36F, static_cast<float>(std::min(cover, 1.0)));
  tbb::parallel_for(0, kCells, [&](int y) {
    // Clouds come in groups (5 km) of single ones (1.3 km).
    auto groups = fractal<2>(kCells / 128, seed_ + 1);
    auto single = fractal<4>(kCells / 32, seed_ + 2);
    std::array<float, kCells> strength;
    for (int x = 0; x < kCells; ++x) {
      const float u = static_cast<float>(x) / 64;
      const float v = static_cast<float>(y) / 64;
      strength[static_cast<std::size_t>(x)] =
          (0.42F * groups.at(u * 0.5F, v * 0.5F) + 0.58F * single.at(u * 2, v * 2) - threshold) /
          0.22F;
    }
    for (int level = 0; level < kLevels; ++level) fill_row(y, level, strength);
  });
}

void Clouds::fill_row(int y, int level, std::span<const float> strength) {
  const float height = (static_cast<float>(level) + 0.5F) / kLevels;
  const float base = smoothstep(0.0F, 0.06F, height);
  auto noise =
      fractal<4>(static_cast<float>(level) * kLevel_m / kCell_m / 16, kCells / 16, seed_ + 3);
  for (int x = 0; x < kCells; ++x) {
    if (strength[static_cast<std::size_t>(x)] <= -0.3F) continue;
    const float room =
        strength[static_cast<std::size_t>(x)] - 1.25F * height * (0.55F + 0.45F * height);
    if (room < -0.45F) continue;
    const float here = noise.at(static_cast<float>(x) / 16, static_cast<float>(y) / 16);
    const float density = clamp01((room + 1.7F * (here - 0.5F)) * 1.9F) * base;
    if (density <= 0) continue;
    column_used_[static_cast<std::size_t>(y * kCells + x)] = 1;
    voxels_[voxel_index(x, y, level)].density = static_cast<std::uint8_t>(density * 255 + 0.5F);
  }
}

// Works from the top down: the optical depth of each level towards the sun follows from the level
// above, one step along the sunbeam.
void Clouds::light_up() {
  const Vector3 sun = sky_.sun_in_world();
  const float up = static_cast<float>(std::max(-sun.z(), 0.15));
  const float shift_x = static_cast<float>(sun.x()) / up * kLevel_m / kCell_m;
  const float shift_y = static_cast<float>(sun.y()) / up * kLevel_m / kCell_m;
  std::vector<float> above(std::size_t{kCells} * kCells, 0.0F);
  std::vector<float> here(above.size());
  const float per_level = kExtinction_per_m * kLevel_m / up / 255;
  const int whole_x = floor_int(shift_x);
  const int whole_y = floor_int(shift_y);
  const float fx = shift_x - static_cast<float>(whole_x);
  const float fy = shift_y - static_cast<float>(whole_y);
  for (int level = kLevels - 1; level >= 0; --level) {
    tbb::parallel_for(0, kCells, [&](int y) {
      const auto at = [&](int i, int j) {
        return above[static_cast<std::size_t>((j & (kCells - 1)) * kCells + (i & (kCells - 1)))];
      };
      for (int x = 0; x < kCells; ++x) {
        const int i = x + whole_x;
        const int j = y + whole_y;
        const float depth =
            lerp(lerp(at(i, j), at(i + 1, j), fx), lerp(at(i, j + 1), at(i + 1, j + 1), fx), fy);
        Voxel& voxel = voxels_[voxel_index(x, y, level)];
        const float own = per_level * voxel.density;
        const float in_front = depth + 0.5F * own;
        voxel.sunlit =
            in_front > 0 ? static_cast<std::uint8_t>(255 * std::exp(-0.25F * in_front)) : 255;
        here[static_cast<std::size_t>(y * kCells + x)] = depth + own;
      }
    });
    std::swap(above, here);
  }
}

Clouds::Sample Clouds::sample(float north_m, float east_m, float height) const {
  const float u = north_m / kCell_m;
  const float v = east_m / kCell_m;
  const int x = floor_int(u);
  const int y = floor_int(v);
  const auto used = [&](int i, int j) {
    return column_used_[static_cast<std::size_t>(((y + j) & (kCells - 1)) * kCells +
                                                 ((x + i) & (kCells - 1)))];
  };
  if ((used(0, 0) | used(1, 0) | used(0, 1) | used(1, 1)) == 0) return {};
  const float w = std::clamp(height * kLevels - 0.5F, 0.0F, kLevels - 1.001F);
  const int level = static_cast<int>(w);
  const float fx = u - static_cast<float>(x);
  const float fy = v - static_cast<float>(y);
  const float fz = w - static_cast<float>(level);
  Sample sum;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const Voxel* voxel = &voxels_[voxel_index(x + i, y + j, level)];
      const float weight = (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
      sum.density += weight * lerp(voxel[0].density, voxel[1].density, fz);
      sum.sunlit += weight * lerp(voxel[0].sunlit, voxel[1].sunlit, fz);
    }
  sum.density /= 255;
  sum.sunlit /= 255;
  return sum;
}

float Clouds::erosion(float north_m, float east_m, float height_m) const {
  const float u = north_m / kDetailTexel_m;
  const float v = east_m / kDetailTexel_m;
  const float w = height_m / kDetailTexel_m;
  const int x = floor_int(u);
  const int y = floor_int(v);
  const int z = floor_int(w);
  const float fx = u - static_cast<float>(x);
  const float fy = v - static_cast<float>(y);
  const float fz = w - static_cast<float>(z);
  // A mask that wraps the index of a texel.
  constexpr int kWrap = kDetail - 1;
  const auto row = [&](int j, int k) {
    const float* at = &detail_[static_cast<std::size_t>(
        (((z + k) & kWrap) * kDetail + ((y + j) & kWrap)) * kDetail)];
    return lerp(at[x & kWrap], at[(x + 1) & kWrap], fx);
  };
  return lerp(lerp(row(0, 0), row(1, 0), fy), lerp(row(0, 1), row(1, 1), fy), fz);
}

// Sunlight that is scattered once, an approximation of multiple scattering (Wrenninge et al. 2013),
// and the light of sky and ground.
LinearRgb Clouds::scattered(const Sample& sample, float height, float phase) const {
  // exp(-depth / 4).
  const float quarter = sample.sunlit;
  const float direct = quarter * quarter * quarter * quarter;
  const float echo = std::sqrt(quarter);
  const float sun = phase * (0.42F * direct + 0.30F * quarter) + 0.22F * echo;
  const LinearRgb ambient = lerp(0.55F, 1.0F, height) * linear_rgb(0.235F, 0.28F, 0.345F);
  return sky_.sunlight() * sun + ambient;
}

// Walks along a ray in steps that grow with the distance.
Clouds::Crossed Clouds::crossed(const Vector3& direction, float up) const {
  const float north = static_cast<float>(direction.x());
  const float east = static_cast<float>(direction.y());
  const float phase = cloud_phase(static_cast<float>(direction.dot(sky_.sun_in_world())));
  const float end = std::min((kBase_m + kDepth_m) / up, kFarthestCloud_m);
  float t = kBase_m / up;
  const float jitter =
      unit(hash(static_cast<int>(north * 65536), static_cast<int>(east * 65536), seed_));
  t += jitter * std::max(28.0F, 0.010F * t);
  Crossed all;
  while (t < end && all.through > 0.01F) {
    const float step = std::max(28.0F, 0.010F * t);
    const float height_m = t * up - kBase_m;
    const Sample here = eroded_sample(t, t * north, t * east, height_m);
    if (here.density <= 0.004F) {
      t += 1.5F * step;
      continue;
    }
    const float pass = std::exp(-kExtinction_per_m * here.density * step);
    const float gain = all.through * (1 - pass);
    all.light += gain * scattered(here, height_m / kDepth_m, phase);
    all.reach_m += gain * t;
    all.through *= pass;
    t += step;
  }
  return all;
}

// The sample with its edges eroded by fine noise. At a large distance that noise is finer than the
// steps, so it fades to its mean.
Clouds::Sample Clouds::eroded_sample(float distance_m,
                                     float north_m,
                                     float east_m,
                                     float height_m) const {
  Sample here = sample(north_m, east_m, height_m / kDepth_m);
  if (here.density > 0) {
    const float fine = lerp(erosion(north_m, east_m, height_m), 0.5F, clamp01(distance_m / 15000));
    here.density = clamp01((here.density - 1.05F * (1 - here.density) * (fine - 0.22F)) * 1.4F);
  }
  return here;
}

LinearRgb Clouds::seen_through(const Vector3& direction, const LinearRgb& behind) const {
  const float up = static_cast<float>(-direction.z());
  LinearRgb colour = behind;
  if (cover_ <= 0 || up < 0.012F) return colour;
  add_cirrus(direction, colour);
  const Crossed clouds = crossed(direction, up);
  if (clouds.through > 0.995F) return colour;
  const float opaque = 1 - clouds.through;
  const float clear = std::exp(-clouds.reach_m / opaque / kHaze_m);
  const float kept = clear * smoothstep(0.012F, 0.05F, up);
  return colour * (1 - opaque * kept) + clouds.light * kept;
}

// Streaks of ice, stretched along one wind direction.
void Clouds::add_cirrus(const Vector3& direction, LinearRgb& colour) const {
  const float up = static_cast<float>(-direction.z());
  const float x = static_cast<float>(direction.x()) * kCirrus_m / up;
  const float y = static_cast<float>(direction.y()) * kCirrus_m / up;
  const float bend = 1800 * (fractal<2>(256, seed_ + 21).at(x / 9000, y / 9000) - 0.5F);
  const float along = 0.85F * x + 0.53F * y;
  const float across = -0.53F * x + 0.85F * y + bend;
  const float patches = fractal<3>(256, seed_ + 22).at(x / 14000, y / 14000);
  const float streaks = fractal<5>(256, seed_ + 23).at(along / 6000, across / 1300);
  const float amount = smoothstep(0.42F, 0.72F, patches) * smoothstep(0.30F, 0.95F, streaks);
  const float kept = 0.34F * amount * smoothstep(0.03F, 0.2F, up);
  colour += kept * (sky_.sunlight() * 0.82F + linear_rgb(0.05F, 0.06F, 0.08F) - colour).max(0.0F);
}

std::vector<float> Clouds::ground_shadow(int cells) const {
  std::vector<float> shadow(pixels_in(cells, cells), 1.0F);
  if (cover_ <= 0) return shadow;
  const Vector3 sun = sky_.sun_in_world();
  const float up = static_cast<float>(std::max(-sun.z(), 0.15));
  const float shift_x = static_cast<float>(sun.x()) / up * kBase_m;
  const float shift_y = static_cast<float>(sun.y()) / up * kBase_m;
  const float cell_m = static_cast<float>(period_m()) / static_cast<float>(cells);
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x) {
      const int i = floor_int((static_cast<float>(x) * cell_m + shift_x) / kCell_m);
      const int j = floor_int((static_cast<float>(y) * cell_m + shift_y) / kCell_m);
      const float quarter = voxels_[voxel_index(i, j, 0)].sunlit / 255.0F;
      shadow[static_cast<std::size_t>(y * cells + x)] = 0.42F + 0.58F * quarter * quarter;
    }
  return shadow;
}

namespace {

// Covers the sky with two ranges of hills, whose heights over the horizon depend on the direction.
void cover(const Vector3& direction,
           float dip,
           const Panorama::Hills& hills,
           float texel_rad,
           const Sky& sky,
           std::uint32_t seed,
           LinearRgb& colour) {
  const auto highest = static_cast<float>(radians(hills.highest_deg));
  const float up = static_cast<float>(-direction.z()) + dip;  // over the horizon
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
        fractal<7>(period, seed + 31 * static_cast<std::uint32_t>(range.layer)).at(azimuth, 0.5F);
    const float top = range.height * clamp01(2.2F * (shape - 0.30F));
    const float covered = smoothstep(-0.7F * texel_rad, 0.7F * texel_rad, top - up);
    const float folds =
        0.8F + 0.5F * fractal<3>(period * 8, seed + 7).at(azimuth * 8, up / range.height * 3);
    // The share of airlight in the light of the hills.
    const auto veil =
        static_cast<float>(1 - std::exp(-range.distance_km * hills.extinction_per_km));
    const LinearRgb hill = haze * veil + slope * folds * (1 - veil);
    colour += (hill - colour) * covered;
  }
}

// How far the panorama goes below the horizon: 1.1 degrees.
constexpr float kBelowHorizon = 0.02F;

}  // namespace

Panorama::Panorama(double texel_rad, double dip_rad)
    : dip_(static_cast<float>(dip_rad)), radius_(static_cast<float>(1 / texel_rad)) {
  const float lowest = dip_ + kBelowHorizon;
  const float edge = radius_ * (std::sqrt((1 + lowest) / (1 - lowest)) + 0.01F) + 4;
  blocks_ = static_cast<int>(2 * edge) / kBlock + 1;
  centre_ = 0.5F * static_cast<float>(blocks_ * kBlock);
  numbers_.assign(pixels_in(blocks_, blocks_), 0);
}

void Panorama::want(float north, float east, float up) {
  if (up < -dip_ - kBelowHorizon) return;
  const float scale = radius_ / (1 + up);
  const int x = static_cast<int>(centre_ + north * scale) / kBlock;
  const int y = static_cast<int>(centre_ + east * scale) / kBlock;
  for (int j = std::max(y - 2, 0); j <= std::min(y + 2, blocks_ - 1); ++j)
    for (int i = std::max(x - 2, 0); i <= std::min(x + 2, blocks_ - 1); ++i)
      numbers_[static_cast<std::size_t>(j * blocks_ + i)] = 1;
}

void Panorama::draw(const Sky& sky, const Clouds& clouds, const Hills& hills, std::uint32_t seed) {
  const float texel_rad = 1 / radius_;
  std::int32_t marked = 0;
  for (std::int32_t& number : numbers_)
    if (number != 0) number = ++marked;
  texels_.assign(place_in(marked + 1, 0, 0), LinearRgb::Zero());
  tbb::parallel_for(0, blocks_ * blocks_, [&](int block) {
    const std::int32_t number = numbers_[static_cast<std::size_t>(block)];
    if (number == 0) return;
    const int left = block % blocks_ * kBlock;
    const int top = block / blocks_ * kBlock;
    for (int y = top; y < top + kSide; ++y)
      for (int x = left; x < left + kSide; ++x) {
        const double u = (static_cast<float>(x) - centre_) / radius_;
        const double v = (static_cast<float>(y) - centre_) / radius_;
        const double square = u * u + v * v;
        const double up = (1 - square) / (1 + square);
        const Vector3 direction(u * (1 + up), v * (1 + up), -up);
        LinearRgb colour = clouds.seen_through(direction, sky.at(direction));
        cover(direction, dip_, hills, texel_rad, sky, seed, colour);
        texels_[place_in(number, x - left, y - top)] = colour;
      }
  });
}

}  // namespace airtruth::synthetic
