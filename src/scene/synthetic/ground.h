// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/synthetic/land.h"
#include "scene/synthetic/mip_map.h"
#include "scene/synthetic/noise.h"
#include "scene/synthetic/rays.h"
#include "scene/synthetic/relief.h"
#include "scene/synthetic/sky.h"

namespace airtruth::synthetic {

// The ground as a repeating tile of colour and height with mip levels. Trees and houses rise from
// it: rays are traced through the height field.
class Ground {
 public:
  // Largest height of trees and houses.
  static constexpr float kHighest_m = 16;

  // `texel_m` is rounded so that the tile's side is a power of two texels. `pixel_rad` is the angle
  // of one pixel.
  Ground(double texel_m,
         double pixel_rad,
         double extinction_per_km,
         const Sky& sky,
         const Clouds& clouds,
         std::uint32_t seed);

  // The light from the ground towards an eye at that place. `down` of all rays is above 0.
  void seen(const Eye& eye, const Rays& rays, Light& light) const;

 private:
  // Numbers of cells along each side of shadow_ and detail_, of sectors of haze_, and of levels of
  // peaks_, whose cells have sides of 10 m to 1,280 m.
  static constexpr int kShadowCells = 512;
  static constexpr int kDetailCells = 256;
  static constexpr int kHazeSectors = 64;
  static constexpr int kPeakLevels = 8;
  // Where rays meet the ground, or what rises from it.
  struct Points {
    // Distance along the ray, and the factor of the shade of trees and houses.
    alignas(64) Floats distance_m;
    alignas(64) Floats shade;
    // Distance to the level ground, and the same up to the farthest ground.
    alignas(64) Floats far_m;
    alignas(64) Floats reach_m;
    // Base-2 logarithm of the pixel's width in texels.
    alignas(64) Floats across;
    // Index of the cell of greatest height.
    alignas(64) Integers cell;
    // The finer of two mip levels, the sector of the haze, and the share of the next of each.
    alignas(64) Integers level;
    alignas(64) Floats level_part;
    alignas(64) Integers sector;
    alignas(64) Floats sector_part;
    // Share of the haze in the light, 0 to 1.
    alignas(64) Floats fog;
    // Place on the ground.
    alignas(64) Floats north_m;
    alignas(64) Floats east_m;
  };
  void paint(const Land& land);
  void plant(const Land& land, std::uint32_t seed);
  void build(std::uint32_t seed);
  void build_village(int k, std::uint32_t seed);
  void build_barn(std::uint32_t id);
  void make_levels();
  void find_peaks();
  void make_haze(const Sky& sky);
  void reach(const Eye& eye, const Rays& rays, Points& points) const;
  void meet(const Eye& eye, const Rays& rays, Points& points) const;
  void look_up(const Eye& eye, const Rays& rays, Points& points) const;
  void colour(const Points& points, int count, Light& light) const;
  void shine(const Points& points, int count, Light& light) const;
  void tree(float north_m, float east_m, float radius_m, float height_m, const LinearRgb& colour);
  void house(float north_m,
             float east_m,
             float angle,
             float length_m,
             float width_m,
             float height_m,
             const LinearRgb& roof);
  void darken(float north_m, float east_m, float radius_m, float factor);
  std::uint32_t& texel(int x, int y);

  float texel_m_;
  float pixel_rad_;
  float extinction_per_m_;
  Vector3 sun_;
  LinearRgb sunlight_;
  LinearRgb skylight_;
  MipMap map_;
  // Greatest heights in and beside square cells, level after level; the cells of each level are
  // twice as wide as those of the level before. They let rays over open fields skip the search.
  std::vector<std::uint8_t> peaks_;
  std::array<std::int32_t, kPeakLevels> first_peak_;
  std::vector<float> shadow_;
  std::vector<float> detail_;
  // The colour to which the ground fades at the horizon, by the cosine of the angle to the sun.
  std::array<std::array<float, kHazeSectors>, 3> haze_;
};

}  // namespace airtruth::synthetic
