// SPDX-License-Identifier: Apache-2.0
#include "camera/horizon/horizon_hold.h"

#include <cmath>

#include "foundation/geometry/within_frame.h"

namespace airtruth::horizon {
namespace {

// The variance of one sighting, rad^2. A detected horizon is off by 0.3 degrees (hills), and the
// error is nearly the same half a second later. The factor 10 counts ten correlated sightings as
// one independent sighting.
const double kSightingVariance = 10 * std::pow(radians(0.3), 2);
// Standard deviations beyond which a sighting is discarded: one in 3,000 right ones (a Rayleigh
// distribution).
constexpr double kGate = 4;

// The shortest rotation that maps one unit vector to another.
Quaternion turn_between(const Vector3& from, const Vector3& to) {
  const Vector3 axis = from.cross(to);
  const double sine = axis.norm();
  if (sine < 1e-15) return Quaternion::Identity();
  return rotation_from_vector(std::atan2(sine, from.dot(to)) / sine * axis);
}

// The angles about x and y of the shortest rotation that maps the z axis to v.
Eigen::Vector2d angles_of(const Vector3& v) {
  const double sine = std::hypot(v.x(), v.y());
  const double angle = std::atan2(sine, v.z());
  return sine < 1e-12 ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(angle / sine * v.head<2>());
}

}  // namespace

void HorizonHold::stray(double sigma_rad) { covariance_(1, 1) += sigma_rad * sigma_rad; }

double HorizonHold::uncertainty_rad() const { return std::sqrt(covariance_(1, 1)); }

Vector3 HorizonHold::up_in_reference(const Eigen::Vector2d& angles) const {
  const double angle = angles.norm();
  if (angle < 1e-15) return *reference_from_up_ * Vector3::UnitZ();
  const Eigen::Vector2d level = std::sin(angle) / angle * angles;
  return *reference_from_up_ * Vector3(level.x(), level.y(), std::cos(angle));
}

bool HorizonHold::see(const Quaternion& cam_from_reference, const Vector3& up_in_cam) {
  const Vector3 up = (cam_from_reference.conjugate() * up_in_cam).normalized();
  if (!reference_from_up_) {
    reference_from_up_ = turn_between(Vector3::UnitZ(), up);
    covariance_(0, 0) = 1;  // the first sighting may have any direction
  }
  const Eigen::Vector2d seen = angles_of(reference_from_up_->conjugate() * up);
  const Eigen::Vector2d expected = state_.colwise().sum();
  const Eigen::Vector2d both(1, 1);
  const double variance = both.dot(covariance_ * both) + kSightingVariance;
  if ((seen - expected).squaredNorm() > kGate * kGate * variance) return false;
  const Eigen::Vector2d gain = covariance_ * both / variance;
  state_ += gain * (seen - expected).transpose();
  covariance_ -= gain * both.transpose() * covariance_;
  return true;
}

std::optional<Vector3> HorizonHold::expected_up(const Quaternion& cam_from_reference) const {
  if (!reference_from_up_) return std::nullopt;
  return cam_from_reference * up_in_reference(state_.colwise().sum());
}

Quaternion HorizonHold::held(const Quaternion& cam_from_reference) const {
  if (!reference_from_up_) return cam_from_reference;
  const Eigen::Vector2d up = state_.row(0);
  const Eigen::Vector2d strayed = state_.colwise().sum();
  const Quaternion turn = turn_between(up_in_reference(up), up_in_reference(strayed));
  return (cam_from_reference * turn).normalized();
}

}  // namespace airtruth::horizon
