// SPDX-License-Identifier: Apache-2.0
#include "runners/association/direction_filter.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace airtruth::association {
namespace {

using Observation = Eigen::Matrix<double, 3, DirectionFilter::kSize>;

// What a sighting says of the state: direction and log size.
Observation observation() {
  Observation h = Observation::Zero();
  h(0, 0) = h(1, 1) = h(2, 4) = 1;
  return h;
}

// The vector of the touching plane that leads along a great circle from `ray` to `other`.
Eigen::Vector2d plane_from_ray(const Vector3& ray,
                               const Eigen::Matrix<double, 3, 2>& axes,
                               const Vector3& other) {
  const Eigen::Vector2d across = axes.transpose() * other;
  const double sine = across.norm();
  if (sine < 1e-12) return across;
  return across * (std::atan2(sine, ray.dot(other)) / sine);
}

}  // namespace

DirectionFilter::DirectionFilter(const Sighting& first)
    : ray_(first.ray_in_cam), log_size_(first.log_size) {
  const Vector3 helper = std::abs(ray_.y()) < 0.9 ? Vector3::UnitY() : Vector3::UnitX();
  axes_.col(0) = helper.cross(ray_).normalized();
  axes_.col(1) = ray_.cross(axes_.col(0));
  covariance_.setZero();
  covariance_.topLeftCorner<2, 2>() = axes_.transpose() * first.ray_covariance * axes_;
  covariance_(2, 2) = covariance_(3, 3) = kInitialRate * kInitialRate;
  covariance_(4, 4) = first.log_size_variance;
}

void DirectionFilter::move(const Eigen::Vector2d& step_rad) {
  const double angle = step_rad.norm();
  if (angle < 1e-15) return;
  const Vector3 forward = axes_ * (step_rad / angle);
  const Eigen::AngleAxisd turn(angle, ray_.cross(forward).normalized());
  ray_ = (turn * ray_).normalized();
  axes_ = turn.toRotationMatrix() * axes_;
}

void DirectionFilter::predict(double seconds,
                              const Quaternion& this_from_previous,
                              double turn_error_rad) {
  move(rate_ * seconds);
  const Matrix3 turn = this_from_previous.toRotationMatrix();
  ray_ = (turn * ray_).normalized();
  axes_ = turn * axes_;

  Covariance transition = Covariance::Identity();
  transition(0, 2) = transition(1, 3) = seconds;
  covariance_ = transition * covariance_ * transition.transpose();
  const double q = kAccelerationDensity;
  for (const int axis : {0, 1}) {
    covariance_(axis, axis) += q * std::pow(seconds, 3) / 3 + turn_error_rad * turn_error_rad;
    covariance_(axis, axis + 2) += q * seconds * seconds / 2;
    covariance_(axis + 2, axis) += q * seconds * seconds / 2;
    covariance_(axis + 2, axis + 2) += q * seconds;
  }
  covariance_(4, 4) += kSizeDensity * seconds;
}

DirectionFilter::Comparison DirectionFilter::compare(const Sighting& sighting) const {
  Comparison comparison;
  comparison.innovation << plane_from_ray(ray_, axes_, sighting.ray_in_cam),
      sighting.log_size - log_size_;
  const Observation h = observation();
  comparison.covariance = h * covariance_ * h.transpose();
  comparison.covariance.topLeftCorner<2, 2>() +=
      axes_.transpose() * sighting.ray_covariance * axes_;
  comparison.covariance(2, 2) += sighting.log_size_variance;
  const Eigen::LLT<Eigen::Matrix3d> cholesky(comparison.covariance);
  comparison.distance = comparison.innovation.dot(cholesky.solve(comparison.innovation));
  comparison.log_determinant =
      2 * Eigen::Matrix3d(cholesky.matrixL()).diagonal().array().log().sum();
  return comparison;
}

bool DirectionFilter::is_near(const Sighting& sighting, double gate) const {
  // An arc is no shorter than its chord, and the variance along any line is at most the trace.
  const double variance = covariance_(0, 0) + covariance_(1, 1) + sighting.ray_covariance.trace();
  return (sighting.ray_in_cam - ray_).squaredNorm() <= gate * variance;
}

void DirectionFilter::update(const Sighting& sighting) {
  const Comparison comparison = compare(sighting);
  const Observation h = observation();
  const Eigen::Matrix<double, kSize, 3> gain =
      covariance_ * h.transpose() * comparison.covariance.llt().solve(Eigen::Matrix3d::Identity());
  const Eigen::Matrix<double, kSize, 1> correction = gain * comparison.innovation;
  // Joseph's form keeps the covariance symmetric and positive.
  Eigen::Matrix3d noise = comparison.covariance - h * covariance_ * h.transpose();
  const Covariance kept = Covariance::Identity() - gain * h;
  covariance_ = kept * covariance_ * kept.transpose() + gain * noise * gain.transpose();
  move(correction.head<2>());
  rate_ += correction.segment<2>(2);
  log_size_ += correction(4);
}

}  // namespace airtruth::association
