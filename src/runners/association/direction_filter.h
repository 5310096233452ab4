// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "foundation/geometry/transform.h"

// A Kalman filter of one target's direction on the sphere: direction, angular rate and the
// logarithm of the angular size.
//
// The state lies in the plane that touches the sphere at the estimated direction. The axes of that
// plane turn with the camera and go along with the direction on its great circle, so that a target
// of constant angular rate has a constant state. The error of the state is
//   (e1, e2) direction in rad, (e3, e4) rate in rad/s, e5 log size,
// along the plane's two axes; it stays below a few degrees, over which the plane and the sphere
// agree within a part in a thousand. (Error-state form: Sola 2017, "Quaternion kinematics for the
// error-state Kalman filter", section 6; motion model: Bar-Shalom, Li and Kirubarajan 2001,
// "Estimation with Applications to Tracking and Navigation", section 6.2.2.)
//
// Example: an aircraft straight ahead drifts 0.01 rad/s to the right of a camera that turns left by
// 0.02 rad in the frame's 0.1 s. After predict() the direction is 0.021 rad to the right.
namespace airtruth::association {

// Spectral density of the angular acceleration, rad^2/s^3, for each axis. Chosen: 0.05^2. An
// aircraft that passes at 60 m/s in 300 m changes its rate by up to 0.05 rad/s in a second.
inline constexpr double kAccelerationDensity = 0.0025;
// Spectral density of the log size's change, 1/s. Chosen: 0.2^2. At 20 s to the closest approach
// size grows by 5 % in a second, at 4 s by 28 %.
inline constexpr double kSizeDensity = 0.04;
// Standard deviation of a new target's angular rate, rad/s. Chosen: 60 m/s across at 600 m.
inline constexpr double kInitialRate = 0.1;

// A direction and a size as seen in one frame.
struct Sighting {
  Vector3 ray_in_cam;  // unit length
  // Covariance of the ray's error, rad^2, in the camera's axes. What it holds along the ray is of
  // no effect.
  Matrix3 ray_covariance;
  double log_size = 0;  // logarithm of the angular size in rad
  double log_size_variance = 0;
};

class DirectionFilter {
 public:
  // Number of errors of the state: direction and rate along two axes, and log size.
  static constexpr int kSize = 5;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  using Innovation = Eigen::Vector3d;  // of the direction along both axes, and of the log size

  explicit DirectionFilter(const Sighting& first);

  // To the next frame. The turn's error is the standard error of a direction through it, rad.
  void predict(double seconds, const Quaternion& this_from_previous, double turn_error_rad);

  // The sighting minus the prediction, and the covariance of this difference.
  struct Comparison {
    Innovation innovation;
    Eigen::Matrix3d covariance;
    // innovation^T covariance^-1 innovation: chi-square with 3 degrees of freedom for the right
    // target.
    double distance = 0;
    double log_determinant = 0;  // of the covariance
  };
  Comparison compare(const Sighting& sighting) const;
  // False only where compare() gives a distance above the gate; a test that costs little.
  bool is_near(const Sighting& sighting, double gate) const;
  void update(const Sighting& sighting);

  const Vector3& ray_in_cam() const { return ray_; }
  // Rate in rad/s as a vector across the ray, in the camera's axes (those of an unturning camera).
  Vector3 rate_in_cam() const { return axes_ * rate_; }
  double log_size() const { return log_size_; }
  const Covariance& covariance() const { return covariance_; }
  // Columns: the two axes of the plane.
  const Eigen::Matrix<double, 3, 2>& axes_in_cam() const { return axes_; }

 private:
  // Moves the direction by a vector of the plane along its great circle, the axes with it.
  void move(const Eigen::Vector2d& step_rad);

  Vector3 ray_;
  Eigen::Matrix<double, 3, 2> axes_;
  Eigen::Vector2d rate_ = Eigen::Vector2d::Zero();
  double log_size_;
  Covariance covariance_;
};

}  // namespace airtruth::association
