// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/transform.h"
#include "scene/synthetic/noise.h"

namespace airtruth::synthetic {

// The cloudless sky: a blue that becomes paler towards the horizon, where the path through the air
// is longer, and the sun with its glow.
class Sky {
 public:
  explicit Sky(const Vector3& sun_in_world);
  LinearRgb at(const Vector3& direction_in_world) const;
  // The colour to which distant objects fade: that of the sky just above the horizon in that
  // direction.
  LinearRgb haze(const Vector3& direction_in_world) const;
  const Vector3& sun_in_world() const { return sun_; }
  LinearRgb sunlight() const { return sunlight_; }

 private:
  Vector3 sun_;
  LinearRgb sunlight_;
};

// Fair-weather cumulus as a volume that repeats every 20 km and shadows itself from the sun, and
// thin cirrus far above. The volume is sampled once, while the sky's panorama is drawn; the frames
// use only its shadow on the ground.
class Clouds {
 public:
  Clouds(const Sky& sky, double cover, std::uint32_t seed);

  // The light of the sky in that direction with the clouds in front of it, from a point near the
  // ground.
  LinearRgb seen_through(const Vector3& direction_in_world, const LinearRgb& behind) const;

  // Share of the sunlight that reaches the ground at each of cells x cells places; 1 is clear.
  std::vector<float> ground_shadow(int cells) const;
  static double period_m();

 private:
  struct Voxel {
    std::uint8_t density = 0;
    // exp(-optical depth towards the sun / 4).
    std::uint8_t sunlit = 0;
  };
  struct Sample {
    float density = 0;
    float sunlit = 0;
  };
  // What a ray meets on its way through the clouds.
  struct Crossed {
    // Share of the light behind the clouds that passes.
    float through = 1;
    // Light that the clouds scatter into the ray.
    LinearRgb light = LinearRgb::Zero();
    // Distance of the clouds times their opacity, metres.
    float reach_m = 0;
  };
  Crossed crossed(const Vector3& direction, float up) const;
  void fill(double cover);
  // The voxels of one row; `strength` of the clouds over each cell along it.
  void fill_row(int y, int level, std::span<const float> strength);
  void light_up();
  Sample sample(float north_m, float east_m, float height) const;
  Sample eroded_sample(float distance_m, float north_m, float east_m, float height_m) const;
  float erosion(float north_m, float east_m, float height_m) const;
  LinearRgb scattered(const Sample& sample, float height, float phase) const;
  void add_cirrus(const Vector3& direction, LinearRgb& colour) const;

  const Sky& sky_;
  std::uint32_t seed_;
  double cover_;
  std::vector<Voxel> voxels_;
  std::vector<std::uint8_t> column_used_;
  std::vector<float> detail_;
};

// Everything at infinity: sky, sun, clouds and hills. The clouds are kilometres away, and the few
// hundred metres of a flight would hardly shift them; they are drawn once, as seen from the start.
//
// The map is stereographic from the nadir: texel = centre + radius (north, east) / (1 + up). This
// one chart has no seams and covers all directions down to slightly below the horizon. Its
// resolution overhead is at least half of that at the horizon.
class Panorama {
 public:
  // `texel_rad`: the angle of a texel at the horizon, which lies `dip_rad` below the horizontal.
  Panorama(double texel_rad, double dip_rad);

  // Marks a direction that frames will look at. draw() fills only the marked parts.
  void want(float north, float east, float up);
  struct Hills {
    double highest_deg = 0;
    double extinction_per_km = 0;
  };
  void draw(const Sky& sky, const Clouds& clouds, const Hills& hills, std::uint32_t seed);

  LinearRgb at(float north, float east, float up) const {
    const float scale = radius_ / (1 + up);
    const float x = centre_ + north * scale;
    const float y = centre_ + east * scale;
    const int ix = static_cast<int>(x);
    const int iy = static_cast<int>(y);
    const LinearRgb* p = &texels_[place_in(block_at(ix, iy), ix % kBlock, iy % kBlock)];
    const float fx = x - static_cast<float>(ix);
    const float fy = y - static_cast<float>(iy);
    const LinearRgb upper = p[0] + (p[1] - p[0]) * fx;
    const LinearRgb lower = p[kSide] + (p[kSide + 1] - p[kSide]) * fx;
    return upper + (lower - upper) * fy;
  }

 private:
  // Side of a part that want() marks, in texels, and of what is kept of it: with the first row and
  // the first column of its neighbours, between which and its own at() interpolates.
  static constexpr int kBlock = 16;
  static constexpr int kSide = kBlock + 1;
  std::int32_t block_at(int x, int y) const {
    return numbers_[static_cast<std::size_t>(y / kBlock * blocks_ + x / kBlock)];
  }
  static std::size_t place_in(std::int32_t number, int x, int y) {
    return static_cast<std::size_t>(number) * (kSide * kSide) +
           static_cast<std::size_t>(y * kSide + x);
  }

  int blocks_ = 0;
  float dip_ = 0;
  float radius_ = 0;
  float centre_ = 0;
  // Of the marked parts, each at its number, behind one without light. Through a long lens they are
  // a small share of the map.
  std::vector<LinearRgb> texels_;
  // Of each part of the map; 0 where it is not marked.
  std::vector<std::int32_t> numbers_;
};

}  // namespace airtruth::synthetic
