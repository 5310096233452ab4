// SPDX-License-Identifier: Apache-2.0
#include "encounter/separation/measures.h"

#include <cmath>

namespace airtruth::separation {
namespace {

using Vector2 = Eigen::Vector2d;

// An angle in degrees, moved into [0, 360).
double in_circle_deg(double angle_deg) {
  const double positive = angle_deg < 0 ? angle_deg + 360 : angle_deg;
  return positive >= 360 ? 0 : positive;
}

void add_directions(Measures& result, const Relative& between, const Vector3& own_velocity_mps) {
  const Vector3& r = between.offset_ned_m;
  const Vector3& v = between.velocity_ned_mps;
  if (result.range_m > 0) {
    result.closing_speed_mps = -r.dot(v) / result.range_m;
    result.line_of_sight_rate_dps = degrees(r.cross(v).norm() / r.squaredNorm());
  }
  if (!(result.horizontal_m > 0)) return;
  const double bearing_rad = std::atan2(r.y(), r.x());
  result.bearing_deg = in_circle_deg(degrees(bearing_rad));
  result.bearing_rate_dps =
      degrees((r.x() * v.y() - r.y() * v.x()) / (result.horizontal_m * result.horizontal_m));
  const Vector2 own = own_velocity_mps.head<2>();
  if (!(own.norm() > kStillMps)) return;
  const double right_deg =
      degrees(std::atan2(own.x() * r.y() - own.y() * r.x(), own.x() * r.x() + own.y() * r.y()));
  result.relative_bearing_deg = right_deg <= -180 ? 180 : right_deg;
}

void add_horizontal(Measures& result, const Relative& between, const MeasureOptions& options) {
  const Vector2 r = between.offset_ned_m.head<2>();
  const Vector2 v = between.velocity_ned_mps.head<2>();
  const double opening = r.dot(v);
  result.hmd_m = result.horizontal_m;
  if (!(v.norm() > kStillMps) || opening > 0) return;
  const double tcpa_s = -opening / v.squaredNorm();
  // The part of the offset across the relative velocity, which stays.
  result.tcpa_s = tcpa_s;
  result.dcpa_m = std::abs(r.x() * v.y() - r.y() * v.x()) / v.norm();
  result.hmd_m =
      tcpa_s <= options.lookahead_s ? *result.dcpa_m : (r + options.lookahead_s * v).norm();
  const double beyond_m2 = (result.horizontal_m - options.tau_distance_m) *
                           (result.horizontal_m + options.tau_distance_m);
  if (beyond_m2 >= 0 && -opening > kStillMps * result.horizontal_m)
    result.tau_mod_s = beyond_m2 / -opening;
}

void add_vertical(Measures& result, const Relative& between, const MeasureOptions& options) {
  const double z = between.offset_ned_m.z();
  const double w = between.velocity_ned_mps.z();
  result.vmd_m = std::abs(z);
  if (!(std::abs(w) > kStillMps) || !(z * w < 0)) return;
  result.tcoa_s = -z / w;
  result.vmd_m = *result.tcoa_s <= options.lookahead_s ? 0 : std::abs(z + options.lookahead_s * w);
}

}  // namespace

Measures measures(const Mover& own, const Mover& intruder, const MeasureOptions& options) {
  const Relative between = relative(own, intruder);
  Measures result;
  result.range_m = between.offset_ned_m.norm();
  result.horizontal_m = between.offset_ned_m.head<2>().norm();
  result.above_m = -between.offset_ned_m.z();
  add_directions(result, between, own.velocity_ned_mps);
  add_horizontal(result, between, options);
  add_vertical(result, between, options);
  return result;
}

}  // namespace airtruth::separation
