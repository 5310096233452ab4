// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "camera/motion/nearness.h"
#include "foundation/geometry/transform.h"

namespace airtruth::motion {

// A point seen twice, as unit vectors.
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

// The rotation that carries one set of bearings to the other: RANSAC (Fischler and Bolles 1981) on
// pairs of points, then least squares (Kabsch 1976; Horn 1987) with the weights of Geman and
// McClure (1987), repeated. limit_rad: of an inlier. Empty where fewer than min_inliers agree, or
// less than 15 % of all, or where all that agree lie about one direction (a turn about it is
// not known).
//
// Where enough points are far, these alone choose the rotation that the fit starts from. How far
// the near ones move against them is then measured, and each counts by what that leaves of it
// (nearness.h).
std::optional<RotationFit> fit_rotation(const std::vector<Bearings>& bearings,
                                        double limit_rad,
                                        int min_inliers,
                                        std::uint64_t seed);

// Least squares alone: argmin sum w |in_cam - R in_reference|^2.
Quaternion best_rotation(const std::vector<Bearings>& bearings, const std::vector<double>& weights);

}  // namespace airtruth::motion
