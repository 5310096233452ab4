// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/synthetic/noise.h"
#include "scene/synthetic/rays.h"
#include "scene/synthetic/sky.h"
#include "scene/synthetic/tile.h"

namespace airtruth::synthetic {

// The ground as a repeating tile of colour and height with mip levels. Trees and houses rise from
// it: rays are traced through the height field.
class Ground {
 public:
  // `texel_m` is that of the tile, `pixel_rad` the angle of one pixel.
  Ground(double texel_m,
         double pixel_rad,
         double extinction_per_km,
         const Sky& sky,
         const Clouds& clouds,
         std::uint32_t seed);

  // The light of pixels from the ground towards an eye at that place. Rays above the horizon see
  // the farthest ground.
  void light(const Eye& eye, const Row::Run& pixels) const;

 private:
  // Numbers of cells along each side of shadow_ and detail_, and of sectors of haze_.
  static constexpr int kShadowCells = 512;
  static constexpr int kDetailCells = 256;
  static constexpr int kHazeSectors = 64;
  void make_haze(const Sky& sky);
  struct Seen;
  void look_up(const Eye& eye, const Row::Run& pixels, Seen& seen) const;
  void colour(const Eye& eye, const Row::Run& pixels, Seen& seen) const;
  void shine(const Eye& eye, const Row::Run& pixels, Seen& seen) const;

  float pixel_rad_;
  float extinction_per_m_;
  Vector3 sun_;
  LinearRgb sunlight_;
  LinearRgb skylight_ = linear_rgb(0.20F, 0.25F, 0.33F);
  Tile tile_;
  std::vector<float> shadow_;
  std::vector<float> detail_;
  // The colour to which the ground fades at the horizon, by the cosine of the angle to the sun.
  std::array<std::array<float, kHazeSectors>, 3> haze_;
};

}  // namespace airtruth::synthetic
