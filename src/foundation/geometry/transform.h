// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include <Eigen/Geometry>

// Rotations, rigid motions and plane maps. docs/conventions.md defines frames, axes and units:
//
//   world  x north, y east, z down; metres
//   body   x forward, y right, z down; metres
//   cam    x right, y down, z forward; metres
//
// A transform's name states both of its frames: p_in_cam = cam_from_world * p_in_world.
//
// Example: an aircraft at (0, 0, -100) in world heads east.
//   const Rigid world_from_aircraft{world_from_body({90, 0, 0}), {0, 0, -100}};
//   world_from_aircraft * Vector3(10, 0, 0) == (0, 10, -100)
// A point 10 m ahead of it lies 10 m east of the origin, at the same height of 100 m.
namespace airtruth {

using Vector3 = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;
using Matrix3 = Eigen::Matrix3d;

constexpr double kPi = 3.14159265358979323846;
constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }
constexpr double degrees(double radians) { return radians * (180.0 / kPi); }

// The angle with whole turns added, so that it lies next to the one before it.
inline double nearest_turn(double angle_deg, double before_deg) {
  return angle_deg + 360.0 * std::round((before_deg - angle_deg) / 360.0);
}

// The unit vector of an azimuth and an elevation above the plane of the first two axes: from north
// towards east in world, from ahead towards the right in body.
//   unit_vector(90, 30) = (0, 0.866, -0.5)
Vector3 unit_vector(double azimuth_deg, double elevation_deg);

// A rigid motion b_from_a: p_in_b = rotation * p_in_a + translation. The rotation is a unit
// quaternion; the translation is the origin of a in b, in metres. The product c_from_b * b_from_a
// is c_from_a.
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
  Eigen::Affine3d affine() const {
    return Eigen::Translation3d(translation) * Eigen::Affine3d(rotation);
  }
};

// An attitude as files state it, in degrees: yaw from north towards east, then pitch nose up, then
// roll right wing down.
struct YawPitchRoll {
  double yaw_deg = 0;
  double pitch_deg = 0;
  double roll_deg = 0;
};

// Numbers as files and the public headers hold them, and as vectors.
inline std::array<double, 3> numbers_of(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
inline std::array<double, 3> numbers_of(const YawPitchRoll& a) {
  return {a.yaw_deg, a.pitch_deg, a.roll_deg};
}
inline Vector3 vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

// world_from_body for an attitude: Rz(yaw) Ry(pitch) Rx(roll).
//   world_from_body({90, 0, 0}) * (1, 0, 0) = (0, 1, 0): the nose points east.
Quaternion world_from_body(const YawPitchRoll& attitude);

// The inverse of world_from_body(attitude). Yaw lies in (-180, 180], pitch in [-90, 90] and roll in
// (-180, 180]. At a pitch of +-90 degrees yaw and roll cannot be separated, and roll is 0.
YawPitchRoll yaw_pitch_roll(const Quaternion& world_from_body);

// Yaw, pitch and roll of the same attitude next to those before it, in degrees: with whole turns
// added, and beyond the pole as (yaw + 180, 180 - pitch, roll + 180) where that is nearer. What
// crosses the pole so has angles without a jump, with a pitch beyond 90 degrees.
Vector3 nearest_angles(const Vector3& angles_deg, const Vector3& before_deg);

// The rotation of a camera that looks along the body's x axis: x_cam = y_body, y_cam = z_body,
// z_cam = x_body.
Quaternion cam_from_body();

// A position in the image, in pixels. (0, 0) is the top-left corner of the image; the centre of the
// first pixel is (0.5, 0.5).
using Pixel = Eigen::Vector2d;
inline Pixel pixel_of(const std::array<double, 2>& numbers) { return {numbers[0], numbers[1]}; }

// A 3x3 projective map b_from_a from pixels of image a to pixels of image b.
using Homography = Eigen::Matrix3d;

// The pixel to which H maps p. Where the third homogeneous coordinate is 0, the result is not
// finite.
inline Pixel apply(const Homography& h, const Pixel& p) {
  const Vector3 q = h * Vector3(p.x(), p.y(), 1.0);
  return {q.x() / q.z(), q.y() / q.z()};
}

}  // namespace airtruth
