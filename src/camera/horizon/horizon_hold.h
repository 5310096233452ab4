// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "foundation/geometry/transform.h"

namespace airtruth::motion {

// Holds a measured rotation by the horizons seen on the way, as far as these know it: pitch and
// roll, not yaw. A Kalman filter (1960) of two unknowns, each an angle in two directions: where up
// is in the reference, and how far the measured rotation has strayed from it by now. The rotation
// strays where key frames are tied together and where tracking began anew; between, it is far
// better than a horizon, and stays as it was.
class HorizonHold {
 public:
  // One frame on: the standard deviation of what was added to the rotation's error.
  void stray(double sigma_rad);
  // How well the stray is known, as a standard deviation.
  double uncertainty_rad() const;
  // A horizon, in this frame's camera, whose measured rotation (cam_from_reference) is given.
  // Returns false, and forgets it, where it lies far from all that was known.
  bool see(const Quaternion& cam_from_reference, const Vector3& up_in_cam);
  // Where up is expected in a frame; empty before the first sighting.
  std::optional<Vector3> expected_up(const Quaternion& cam_from_reference) const;
  // The measured rotation, corrected by the horizons.
  Quaternion held(const Quaternion& cam_from_reference) const;

 private:
  Vector3 up_in_reference(const Eigen::Vector2d& angles) const;
  std::optional<Quaternion> reference_from_up_;      // z along the first horizon's up
  Eigen::Matrix2d state_ = Eigen::Matrix2d::Zero();  // rows: up, stray; columns: the two angles
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Zero();  // of up and stray
};

}  // namespace airtruth::motion
