// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/synthetic/clouds.h"
#include "scene/synthetic/ground_tile.h"
#include "scene/synthetic/sky.h"

namespace airtruth::synthetic {

// Place of the camera.
struct Eye {
  float north_m = 0;
  float east_m = 0;
  float height_m = 0;
};

// Unit direction of a ray into the world: north, east and down. Its fourth number has no meaning.
using Ray = Eigen::Array4f;

// The ground as the camera sees it: trees and houses rise from it, clouds shade it, and the air
// fades it to the sky's colour.
class Ground {
 public:
  // `pixel_rad` is the angle of one pixel; `altitude_m` decides how fine the tile is.
  Ground(double altitude_m,
         double pixel_rad,
         double extinction_per_km,
         const Sky& sky,
         const Clouds& clouds,
         std::uint32_t seed);

  // The light from the ground towards the eye. The ray looks down.
  LinearRgb seen(const Eye& eye, const Ray& ray) const;

 private:
  struct Hit {
    float distance_m = 0;
    // Factor of the shade of trees and houses.
    float shade = 1;
  };
  Hit meet(const Eye& eye, const Ray& ray, float across) const;
  LinearRgb lit(const Hit& hit, const Eye& eye, const Ray& ray, float level) const;
  LinearRgb haze(const Ray& ray) const;

  float pixel_rad_;
  float extinction_per_m_;
  Vector3 sun_;
  LinearRgb sunlight_;
  LinearRgb skylight_;
  GroundTile tile_;
  // Share of the sunlight that the clouds let through.
  Tile<float> shadow_;
  // Mottling that is finer than the tile's texels.
  Tile<float> detail_;
  // The colour to which the ground fades at the horizon, by the cosine of the angle to the sun.
  std::vector<LinearRgb> haze_;
};

}  // namespace airtruth::synthetic
