// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "foundation/geometry/transform.h"

namespace airtruth {

constexpr double kEarthRadiusM = 6'371'008.8;  // mean radius R1 of the WGS 84 ellipsoid (IUGG)

// The angle by which the visible horizon of level ground lies below the horizontal, from a height
// above the ground (0 and below: 0): that of the line of sight which touches a sphere of the
// Earth's mean radius. It is 0.39 degrees at 150 m. Refraction, which takes some 8 % off, is left
// out.
inline double horizon_dip_rad(double height_m) {
  return std::acos(kEarthRadiusM / (kEarthRadiusM + std::max(0.0, height_m)));
}

// The angle of a place above that horizon as it is seen from an eye, north-east-down, with the
// ground at down = 0.
inline double above_horizon_rad(const Vector3& place_ned_m, const Vector3& eye_ned_m) {
  const Vector3 way = place_ned_m - eye_ned_m;
  return std::atan2(-way.z(), std::hypot(way.x(), way.y())) + horizon_dip_rad(-eye_ned_m.z());
}

}  // namespace airtruth
