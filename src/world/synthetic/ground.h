// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "world/synthetic/clouds.h"
#include "world/synthetic/land.h"
#include "world/synthetic/noise.h"
#include "world/synthetic/sky.h"

namespace airtruth::synthetic {

// The ground as a repeating tile of colour and height with mip levels. Trees and houses rise from
// it: rays are traced through the height field (relief mapping; Policarpo, Oliveira and Comba
// 2005).
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

  // The light from the ground towards an eye at that place. `north`, `east` and `down` form a unit
  // vector with `down` > 0.
  LinearRgb seen(float eye_north_m,
                 float eye_east_m,
                 float eye_height_m,
                 float north,
                 float east,
                 float down) const;

  // The colour to which the ground fades at the horizon, by direction.
  LinearRgb haze(float north, float east) const;

 private:
  static constexpr int kShadowCells = 512;
  static constexpr int kDetailCells = 256;
  static constexpr int kHazeSectors = 64;
  struct Level {
    int size = 0;
    // Square roots of red, green and blue, and the height.
    std::vector<std::uint32_t> texels;
  };
  struct Texel {
    // Square roots of the light.
    LinearRgb colour = LinearRgb::Zero();
    float height_m = 0;
  };
  void paint(const Land& land);
  void plant(const Land& land, std::uint32_t seed);
  void build(std::uint32_t seed);
  void build_village(int k, std::uint32_t seed);
  void build_barn(std::uint32_t id);
  void make_levels();
  void find_peaks();
  float peak_m(float north_m, float east_m, float span_m) const;
  // The point where a ray meets a tree or a house, with the factor of its shade; empty where the
  // ray meets none.
  struct Meeting {
    float distance_m = 0;
    float shade = 1;
  };
  std::optional<Meeting> meet(float eye_north_m,
                              float eye_east_m,
                              float north,
                              float east,
                              float down,
                              float far_m,
                              float across) const;
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
  // Of the texel.
  float height_m(float x, float y, int level) const;
  float smooth_height_m(float x, float y, int level) const;
  LinearRgb colour(float x, float y, float level) const;
  float sunlit(float north_m, float east_m) const;
  float detail(float north_m, float east_m) const;

  float texel_m_;
  float pixel_rad_;
  float extinction_per_m_;
  Vector3 sun_;
  LinearRgb sunlight_;
  LinearRgb skylight_;
  std::vector<Level> levels_;
  // Greatest heights in and beside square cells; the cells of each level are twice as wide as those
  // of the level before. They let rays over open fields skip the search.
  std::vector<std::vector<std::uint8_t>> peaks_;
  std::vector<float> shadow_;
  std::vector<float> detail_;
  std::vector<LinearRgb> haze_;
};

}  // namespace airtruth::synthetic
