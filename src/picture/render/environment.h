// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>

#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"

// Light from all around but the sun's disc: a radiance by direction, held as the nine spherical
// harmonics up to order 2. That keeps the irradiance of any sky on a Lambert surface within 1 % on
// average, 9 % at worst (Ramamoorthi and Hanrahan 2001, "An efficient representation for irradiance
// environment maps").
namespace airtruth::render {

using image::Rgb;

class Environment {
 public:
  Environment() = default;  // black

  // Projects a radiance, linear RGB by unit direction in world axes (north, east, down), by sums
  // over a grid of directions.
  static Environment of(const std::function<Rgb(const Vector3& direction_in_world)>& radiance);

  // Sums and multiples are those of the radiances; a multiple is by channel.
  Environment& operator+=(const Environment& other);
  Environment scaled(const Rgb& by) const;

  // Irradiance over pi on a surface with that unit normal: the radiance that a white Lambert
  // surface gives back. Not below 0.
  Rgb irradiance_over_pi(const Eigen::Vector3f& normal_in_world) const;
  // The radiance itself, smoothed as order 2 is. Not below 0.
  Rgb radiance(const Eigen::Vector3f& direction_in_world) const;

 private:
  Rgb sum(const Eigen::Vector3f& direction, const std::array<float, 3>& by_order) const;

  std::array<Rgb, 9> coefficients_{};  // of the radiance
};

}  // namespace airtruth::render
