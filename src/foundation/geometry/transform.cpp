// SPDX-License-Identifier: Apache-2.0
#include "foundation/geometry/transform.h"

#include <algorithm>
#include <cmath>

namespace airtruth {

Vector3 unit_vector(double azimuth_deg, double elevation_deg) {
  const double a = radians(azimuth_deg), e = radians(elevation_deg);
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), -std::sin(e)};
}

Quaternion world_from_body(const YawPitchRoll& attitude) {
  using Eigen::AngleAxisd;
  return Quaternion(AngleAxisd(radians(attitude.yaw_deg), Vector3::UnitZ()) *
                    AngleAxisd(radians(attitude.pitch_deg), Vector3::UnitY()) *
                    AngleAxisd(radians(attitude.roll_deg), Vector3::UnitX()));
}

YawPitchRoll yaw_pitch_roll(const Quaternion& world_from_body) {
  const Matrix3 r = world_from_body.toRotationMatrix();
  const double sin_pitch = std::clamp(-r(2, 0), -1.0, 1.0);
  if (std::abs(sin_pitch) > 1.0 - 1e-12)
    return {degrees(std::atan2(-r(0, 1), r(1, 1))), std::copysign(90.0, sin_pitch), 0.0};
  return {degrees(std::atan2(r(1, 0), r(0, 0))),
          degrees(std::asin(sin_pitch)),
          degrees(std::atan2(r(2, 1), r(2, 2)))};
}

Vector3 nearest_angles(const Vector3& angles_deg, const Vector3& before_deg) {
  const auto next_to = [&before_deg](Vector3 angles) {
    for (int i = 0; i < 3; ++i) angles[i] = nearest_turn(angles[i], before_deg[i]);
    return angles;
  };
  const Vector3 stated = next_to(angles_deg);
  const Vector3 other = next_to({angles_deg[0] + 180, 180 - angles_deg[1], angles_deg[2] + 180});
  return (other - before_deg).lpNorm<1>() < (stated - before_deg).lpNorm<1>() ? other : stated;
}

Quaternion cam_from_body() {
  Matrix3 r;
  r << 0, 1, 0,  //
      0, 0, 1,   //
      1, 0, 0;
  return Quaternion(r);
}

}  // namespace airtruth
