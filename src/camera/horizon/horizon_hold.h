// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "foundation/geometry/transform.h"

namespace airtruth::horizon {

// Corrects the drift of a measured rotation in pitch and roll by the horizons that are detected on
// the way. Yaw is not observable. The filter (Kalman 1960) has two unknowns, each an angle in two
// directions: the direction of up in the reference, and the error of the measured rotation by now.
// The error grows where key frames are linked to one another and where tracking starts anew.
// Between these events the rotation is far more accurate than a detected horizon, and the filter
// leaves it as it is.
class HorizonHold {
 public:
  // Adds the error that the rotation gained since the previous frame, as a standard deviation.
  void stray(double sigma_rad);
  // The standard deviation of the error of the rotation.
  double uncertainty_rad() const;
  // Updates the filter by a horizon in a frame whose measured rotation (cam_from_reference) is
  // given. Returns false and ignores the horizon where it lies more than 4 standard deviations from
  // the prediction.
  bool see(const Quaternion& cam_from_reference, const Vector3& up_in_cam);
  // The predicted up direction in a frame's camera; empty before the first horizon.
  std::optional<Vector3> expected_up(const Quaternion& cam_from_reference) const;
  // The measured rotation with the correction applied.
  Quaternion held(const Quaternion& cam_from_reference) const;

 private:
  Vector3 up_in_reference(const Eigen::Vector2d& angles) const;
  std::optional<Quaternion> reference_from_up_;      // its z axis is the first horizon's up
  Eigen::Matrix2d state_ = Eigen::Matrix2d::Zero();  // rows: up, stray; columns: the two angles
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Zero();  // of up and stray
};

}  // namespace airtruth::horizon
