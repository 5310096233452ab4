// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace airtruth {

constexpr double kEarthRadiusM = 6'371'008.8;  // mean radius R1 of the WGS 84 ellipsoid (IUGG)

// The angle by which the visible horizon of level ground lies below the horizontal, from a height
// above the ground (0 and below: 0): that of the line of sight which touches a sphere of the
// Earth's mean radius. It is 0.39 degrees at 150 m. Refraction, which takes some 8 % off, is left
// out.
inline double horizon_dip_rad(double height_m) {
  return std::acos(kEarthRadiusM / (kEarthRadiusM + std::max(0.0, height_m)));
}

}  // namespace airtruth
