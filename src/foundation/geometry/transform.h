// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

// Rotations and rigid motions. Frames, axes and units: docs/conventions.md.
//
//   world  north-east-down, metres       body  x forward, y right, z down      cam  x right, y
//   down, z forward
//
// Names say both ends: p_in_cam = cam_from_world * p_in_world.
namespace airtruth {

using Vector3 = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;
using Matrix3 = Eigen::Matrix3d;

constexpr double kPi = 3.14159265358979323846;
constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }
constexpr double degrees(double radians) { return radians * (180.0 / kPi); }

// b_from_a: p_in_b = rotation * p_in_a + translation.
struct Rigid {
  Quaternion rotation = Quaternion::Identity();
  Vector3 translation = Vector3::Zero();

  Vector3 operator*(const Vector3& p) const { return rotation * p + translation; }
  Rigid operator*(const Rigid& b_from_a) const {
    return {(rotation * b_from_a.rotation).normalized(), *this * b_from_a.translation};
  }
  Rigid inverse() const {
    const Quaternion back = rotation.conjugate();
    return {back, back * (-translation)};
  }
};

// Attitude in files: yaw from north towards east, then pitch nose up, then roll right wing down;
// degrees.
struct YawPitchRoll {
  double yaw_deg = 0;
  double pitch_deg = 0;
  double roll_deg = 0;
};

// world_from_body for an attitude: Rz(yaw) Ry(pitch) Rx(roll).
//   world_from_body({90, 0, 0}) * (1, 0, 0) = (0, 1, 0): the nose points east.
Quaternion world_from_body(const YawPitchRoll& attitude);

// The inverse. Yaw in (-180, 180], pitch in [-90, 90], roll in (-180, 180]; at pitch = +-90 roll is
// 0.
YawPitchRoll yaw_pitch_roll(const Quaternion& world_from_body);

// A camera that looks along the body's x axis: x_cam = y_body, y_cam = z_body, z_cam = x_body.
Quaternion cam_from_body();

// A pixel's place. (0, 0) is the top-left corner of the image, the first pixel's centre is (0.5,
// 0.5).
using Pixel = Eigen::Vector2d;

// A 3x3 projective map of pixel to pixel, b_from_a.
using Homography = Eigen::Matrix3d;

// Where H takes p. At the horizon of H (denominator 0) the result is not finite.
inline Pixel apply(const Homography& h, const Pixel& p) {
  const Vector3 q = h * Vector3(p.x(), p.y(), 1.0);
  return {q.x() / q.z(), q.y() / q.z()};
}

}  // namespace airtruth
