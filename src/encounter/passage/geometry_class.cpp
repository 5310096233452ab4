// SPDX-License-Identifier: Apache-2.0
#include "encounter/passage/geometry_class.h"

#include <algorithm>
#include <cmath>

namespace airtruth::encounter {
namespace {

constexpr double kEarthRadiusM = 6'371'008.8;  // mean radius R1 of the WGS 84 ellipsoid

}  // namespace

std::optional<Meeting> meeting_of(const Mover& own, const Mover& intruder) {
  const Eigen::Vector2d a = own.velocity_ned_mps.head<2>();
  const Eigen::Vector2d b = intruder.velocity_ned_mps.head<2>();
  if (a.norm() < kCourseMps || b.norm() < kCourseMps) return std::nullopt;
  const double right_deg = degrees(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
  if (std::abs(right_deg) >= kHeadOnDeg) return Meeting::kHeadOn;
  if (std::abs(right_deg) >= kOvertakingDeg)
    return right_deg > 0 ? Meeting::kCrossingFromLeft : Meeting::kCrossingFromRight;
  const double faster_mps = a.norm() - b.dot(a.normalized());
  if (std::abs(faster_mps) < kStillMps) return std::nullopt;
  return faster_mps > 0 ? Meeting::kOvertaking : Meeting::kOvertaken;
}

VerticalMotion vertical_motion_of(const Mover& intruder) {
  const double climb_mps = -intruder.velocity_ned_mps.z();
  if (climb_mps >= kClimbingMps) return VerticalMotion::kClimbing;
  return climb_mps <= -kClimbingMps ? VerticalMotion::kDescending : VerticalMotion::kLevel;
}

double horizon_dip_deg(double height_m) {
  return degrees(std::acos(kEarthRadiusM / (kEarthRadiusM + std::max(0.0, height_m))));
}

AgainstHorizon against_horizon(const Mover& own, const Mover& intruder, double half_height_deg) {
  const Vector3 r = intruder.position_ned_m - own.position_ned_m;
  const double elevation_deg = degrees(std::atan2(-r.z(), std::hypot(r.x(), r.y())));
  const double above_deg = elevation_deg + horizon_dip_deg(-own.position_ned_m.z());
  if (std::abs(above_deg) <= half_height_deg) return AgainstHorizon::kOn;
  return above_deg > 0 ? AgainstHorizon::kAbove : AgainstHorizon::kBelow;
}

}  // namespace airtruth::encounter
