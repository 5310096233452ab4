// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "camera/motion/nearness.h"
#include "foundation/geometry/transform.h"

namespace airtruth::motion {

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
// starts. The parallax of the near points is then measured, and it reduces their weights
// (nearness.h).
std::optional<RotationFit> fit_rotation(const std::vector<Bearings>& bearings,
                                        double limit_rad,
                                        int min_inliers,
                                        std::uint64_t seed);

// Least squares alone: argmin sum w |in_cam - R in_reference|^2.
Quaternion best_rotation(const std::vector<Bearings>& bearings, const std::vector<double>& weights);

}  // namespace airtruth::motion
