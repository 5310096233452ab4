// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/geometry/transform.h"

// The weights of near points. While the camera flies, near ground moves against far points
// (parallax), and an intruder moves with the far points. Over level ground the parallax of a point
// is at most (distance flown / height) x sine of its depression below the horizon, because its
// range is height / sine. The amount of parallax is estimated from the corners themselves.
namespace airtruth::motion {

// The depression below the horizon, in degrees, under which ground counts as far: its range is then
// 14 heights or more. At 25 m/s and a height of 50 m such ground moves by 0.05 mrad per frame of
// 1/30 s against the horizon.
constexpr double kFarDepressionDeg = 4;

struct Nearness {
  // The sine of the depression times the number of frames between two views. It is 0 above the
  // horizon, and where the horizon is unknown.
  double value = 0;
  bool is_far = true;  // above the horizon or less than kFarDepressionDeg under it
};

// The ray and the up direction are in the same camera frame; up is a unit vector.
inline Nearness nearness_of(const Vector3& ray_in_any,
                            const Vector3& up_in_any,
                            std::int64_t frames) {
  const double sine = std::max(0.0, -up_in_any.dot(ray_in_any) / ray_in_any.norm());
  return {sine * static_cast<double>(frames), sine < std::sin(radians(kFarDepressionDeg))};
}

// The directions of a point in two frames, as unit vectors.
struct Bearings {
  Vector3 in_reference;
  Vector3 in_cam;
  Nearness near = {};
};

struct RotationFit {
  Quaternion cam_from_reference = Quaternion::Identity();
  std::vector<bool> is_inlier;
  int inliers = 0;
  double rms_rad = 0;  // of the inliers
};

// The rotation that maps one set of bearings to the other: RANSAC (Fischler and Bolles 1981) on
// pairs of points, then repeated least squares (Kabsch 1976; Horn 1987) with the weights of Geman
// and McClure (1987). limit_rad is the largest residual of an inlier. The result is empty with
// fewer than min_inliers inliers or fewer than 15 % of all points, and where all inliers lie close
// to one direction, since the rotation about that direction is then unknown.
//
// Where enough points are far, the far points alone determine the rotation with which the fit
// starts. The parallax of the near points is then measured, and it reduces their weights.
std::optional<RotationFit> fit_rotation(const std::vector<Bearings>& bearings,
                                        double limit_rad,
                                        int min_inliers,
                                        std::uint64_t seed);

// Least squares alone: argmin sum w |in_cam - R in_reference|^2.
Quaternion best_rotation(const std::vector<Bearings>& bearings, const std::vector<double>& weights);

}  // namespace airtruth::motion
