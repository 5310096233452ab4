// SPDX-License-Identifier: Apache-2.0
#include "sequence/evision/evision_motion.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace airtruth::sequence {
namespace {

using Parameters = Eigen::Vector4d;  // shift (px), roll (rad), drift

// Standard error of a box's centre, px.
constexpr double kCentrePx = 3;
constexpr double kPrior = 0.1;
constexpr int kIterations = 15;

Homography homography_of(const Parameters& p, const Pixel& centre, double focal_px) {
  Homography to = Homography::Identity();
  to.topRightCorner<2, 1>() = centre;
  Homography from = Homography::Identity();
  from.topRightCorner<2, 1>() = -centre;
  Homography drift = Homography::Identity();
  drift(2, 1) = -p[3] / focal_px;
  Homography turn = Homography::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(p[2]).toRotationMatrix();
  turn.topRightCorner<2, 1>() = p.head<2>();
  return to * turn * drift * from;
}

}  // namespace

Homography motion_from_sightings(const std::vector<Sighting>& sightings,
                                 const Pixel& principal_point_px,
                                 double focal_px) {
  Parameters p = Parameters::Zero();
  if (sightings.empty()) return Homography::Identity();
  const auto rows = static_cast<Eigen::Index>(2 * sightings.size());
  const auto residual = [&](const Parameters& at) {
    const Homography h = homography_of(at, principal_point_px, focal_px);
    Eigen::VectorXd r(rows + 2);
    for (Eigen::Index i = 0; i < rows / 2; ++i) {
      const Sighting& s = sightings[static_cast<std::size_t>(i)];
      r.segment<2>(2 * i) = (apply(h, s.still_px) - s.found_px) / kCentrePx;
    }
    r.tail<2>() = at.tail<2>() / kPrior;
    return r;
  };
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::VectorXd r = residual(p);
    Eigen::MatrixXd jacobian(rows + 2, 4);
    for (Eigen::Index k = 0; k < 4; ++k) {
      constexpr double kStep = 1e-5;
      Parameters moved = p;
      moved[k] += kStep;
      jacobian.col(k) = (residual(moved) - r) / kStep;
    }
    const Parameters step =
        (jacobian.transpose() * jacobian).ldlt().solve(-jacobian.transpose() * r);
    if (!step.allFinite()) break;
    p += step;
    if (step.norm() < 1e-9) break;
  }
  return homography_of(p, principal_point_px, focal_px);
}

}  // namespace airtruth::sequence
