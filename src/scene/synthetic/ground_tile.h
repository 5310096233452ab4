// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "foundation/geometry/transform.h"
#include "scene/synthetic/land.h"
#include "scene/synthetic/noise.h"

namespace airtruth::synthetic {

// The ground as a square picture of kLand_m, which repeats, of colour and of the height of trees
// and houses, with its mip levels (Williams 1983). A texel packs the square roots of red, green and
// blue, and the height, from the lowest byte to the highest.
class GroundTile {
 public:
  // Largest height of trees and houses.
  static constexpr float kHighest_m = 16;

  // The side of a texel is about `texel_m`, so that the tile's side is a power of two texels.
  GroundTile(double texel_m, const Vector3& sun_in_world, std::uint32_t seed);

  float texel_m() const { return texel_m_; }
  // The level above the last but one is never asked for alone: levels are read in pairs.
  int last_level() const { return static_cast<int>(levels_.size()) - 2; }
  // Red, green and blue as square roots, 0..1, and the height as a share of kHighest_m.
  LinearRgb at(int level, float north_m, float east_m) const;
  // The height of the texel at the place, without interpolation.
  float height_m(int level, float north_m, float east_m) const;
  // Nothing within kPeakReach_m of the place is higher.
  static constexpr float kPeakReach_m = 40;
  float peak_m(float north_m, float east_m) const;

 private:
  void paint(const Land& land);
  void plant(const Land& land, std::uint32_t seed);
  void build_village(std::uint32_t id, int village, std::uint32_t seed);
  void build_barn(std::uint32_t id);
  void darken(float north_m, float east_m, float radius_m, float factor);
  void tree(float north_m, float east_m, float radius_m, float height_m, const LinearRgb& colour);
  struct House {
    float north_m, east_m, angle_rad, length_m, width_m, height_m;
    LinearRgb roof;
  };
  void house(const House& house);
  void make_levels();
  void find_peaks();
  // Calls change(texel, x, y) for all texels of level 0 within a square around the place. x and y
  // are relative to the place, in texels.
  template <typename Change>
  void around(float north_m, float east_m, float reach_m, const Change& change);

  float texel_m_ = 0;
  Vector3 sun_;
  std::vector<Tile<std::uint32_t>> levels_;
  // Greatest heights in and beside square cells of kPeakReach_m.
  Tile<std::uint8_t> peaks_;
};

}  // namespace airtruth::synthetic
