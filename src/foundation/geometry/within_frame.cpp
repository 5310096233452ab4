// SPDX-License-Identifier: Apache-2.0
#include "foundation/geometry/within_frame.h"

#include <cmath>

namespace airtruth {

Quaternion rotation_from_vector(const Vector3& vector_rad) {
  const double angle = vector_rad.norm();
  if (angle < 1e-12) return Quaternion::Identity();
  return Quaternion(Eigen::AngleAxisd(angle, vector_rad / angle));
}

Vector3 vector_from_rotation(const Quaternion& rotation) {
  const Eigen::AngleAxisd turned(rotation);
  const double angle = turned.angle() > kPi ? turned.angle() - 2 * kPi : turned.angle();
  return angle * turned.axis();
}

Rigid carried(const Rigid& world_from_x, const Twist& twist, double dt_s) {
  return {(rotation_from_vector(dt_s * twist.rate_radps) * world_from_x.rotation).normalized(),
          world_from_x.translation + dt_s * twist.velocity_mps};
}

double Shutter::middle_s(const Pixel& pixel, int width, int height) const {
  if (readout_s <= 0) return 0;
  const double down = (std::floor(pixel.y()) + 0.5) / height - 0.5;
  const double right = (std::floor(pixel.x()) + 0.5) / width - 0.5;
  switch (readout) {
    case Readout::kDown:
      return readout_s * down;
    case Readout::kUp:
      return -readout_s * down;
    case Readout::kRight:
      return readout_s * right;
    case Readout::kLeft:
      return -readout_s * right;
  }
  return 0;
}

}  // namespace airtruth
