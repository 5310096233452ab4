// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"

// The light from all directions except the sun's disc: a radiance by direction, stored as nine
// spherical harmonics up to order 2. They represent the irradiance of any sky on a Lambert surface
// within 1 % on average and 9 % at worst (Ramamoorthi and Hanrahan 2001, "An efficient
// representation for irradiance environment maps").
namespace airtruth::shade {

using image::Rgb;

class Environment {
 public:
  // Black.
  Environment() = default;

  // Projects a radiance onto the harmonics by sums over a grid of directions. `radiance` maps a
  // unit direction in world axes (north, east, down) to linear RGB.
  static Environment of(const std::function<Rgb(const Vector3& direction_in_world)>& radiance);

  // Sums and multiples of environments are those of their radiances. scaled() multiplies by
  // channel.
  Environment& operator+=(const Environment& other);
  Environment scaled(const Rgb& by) const;
  // The same light for directions in another frame.
  Environment turned(const Eigen::Matrix3f& world_from_other) const;

  // Irradiance over pi on a surface with that unit normal: the radiance that a white Lambert
  // surface reflects. Never below 0.
  Rgb irradiance_over_pi(const Eigen::Vector3f& normal_in_world) const;
  // The radiance itself, smoothed to order 2. Never below 0.
  Rgb radiance(const Eigen::Vector3f& direction_in_world) const;

 private:
  Rgb sum(const Eigen::Vector3f& direction, const std::array<float, 3>& by_order) const;

  // Of the radiance; the fourth channel is 0.
  Eigen::Array<float, 4, 9> coefficients_ = Eigen::Array<float, 4, 9>::Zero();
};

// The light of a scene. All colours are linear RGB.
struct Light {
  // Unit vector towards the sun.
  Vector3 to_sun_in_world{0, 0, -1};
  // Irradiance over pi on a surface that faces the sun.
  std::array<float, 3> sun = {1, 1, 1};
  // From directly above.
  std::array<float, 3> sky = {0.3f, 0.3f, 0.3f};
  // From directly below.
  std::array<float, 3> ground = {0.1f, 0.1f, 0.1f};
  // Replaces sky and ground: the light by direction. The aircraft hides a part of it from itself,
  // and paint with a clear coat mirrors it. Empty: the hemisphere of sky and ground, as in the
  // OpenGL renderer of `backdrop`.
  std::optional<Environment> surroundings = {};
};

}  // namespace airtruth::shade
