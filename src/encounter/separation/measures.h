// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "foundation/geometry/transform.h"
#include "foundation/geometry/units.h"

// How two aircraft stand to each other at one instant: the measures of detect-and-avoid, for
// aircraft that keep their present velocity. Source of the measures: Munoz et al. 2014 ("A Family
// of Well-Clear Boundary Models for the Integration of UAS in the NAS", NASA/TM-2014-218280) and
// RTCA DO-365.
//
// Example: the own aircraft flies north at 100 m/s; an intruder 4000 m ahead, 200 m to the right
// and 300 m higher flies south at 100 m/s and descends at 5 m/s. They close at 200 m/s in the
// plane: tcpa_s = 20, dcpa_m = hmd_m = 200, and tcoa_s = 60.
namespace airtruth::separation {

// An aircraft as a point in uniform motion, north-east-down.
struct Mover {
  Vector3 position_ned_m = Vector3::Zero();
  Vector3 velocity_ned_mps = Vector3::Zero();
};

// The position of the intruder from the own aircraft and its change.
struct Relative {
  Vector3 offset_ned_m = Vector3::Zero();
  Vector3 velocity_ned_mps = Vector3::Zero();
};
inline Relative relative(const Mover& own, const Mover& intruder) {
  return {intruder.position_ned_m - own.position_ned_m,
          intruder.velocity_ned_mps - own.velocity_ned_mps};
}

// Slower relative motion, and slower closing, counts as none, in m/s: it changes a separation by
// less than 1 mm in ten days, and it is what rounding leaves of equal velocities, and of the
// closing speed of aircraft that pass abeam (1e-13 m/s at 300 m/s). A time to come is then at most
// that of the separation at this speed.
constexpr double kStillMps = 1e-9;

struct MeasureOptions {
  // How far ahead the miss distances look. 180 s is the lookahead of DAIDALUS for DO-365.
  double lookahead_s = 180;
  // The distance of the modified tau, DMOD. 0.66 nmi is that of DO-365 (appendix C).
  double tau_distance_m = 0.66 * kMetresOfNauticalMile;
};

// A measure that is not defined is empty; no measure is ever NaN or infinite.
struct Measures {
  // Distance in space, over the ground plane, and in height (the intruder is higher: positive).
  double range_m = 0;
  double horizontal_m = 0;
  double above_m = 0;
  // The rate at which the range decreases; negative while it increases. Empty at range 0.
  std::optional<double> closing_speed_mps;
  // Direction of the intruder from the own aircraft, from north towards east, in [0, 360), and its
  // rate. Empty for an intruder straight above or below.
  std::optional<double> bearing_deg;
  std::optional<double> bearing_rate_dps;
  // The same direction from the own course, right positive, in (-180, 180]. Empty where the own
  // aircraft does not move over the ground.
  std::optional<double> relative_bearing_deg;
  // Rate at which the direction to the intruder turns in space. Empty at range 0.
  std::optional<double> line_of_sight_rate_dps;
  // Time to the horizontal closest approach, and the horizontal distance there. Empty while the
  // aircraft diverge, and where they keep their separation.
  std::optional<double> tcpa_s;
  std::optional<double> dcpa_m;
  // The least horizontal distance and the least difference of height within the lookahead, each
  // taken on its own.
  double hmd_m = 0;
  double vmd_m = 0;
  // Modified tau: (DMOD^2 - horizontal^2) / (offset . velocity). Empty unless the aircraft converge
  // over the ground, by more than kStillMps, from beyond DMOD.
  std::optional<double> tau_mod_s;
  // Time to the same height. Empty unless the aircraft converge in height.
  std::optional<double> tcoa_s;
};

Measures measures(const Mover& own, const Mover& intruder, const MeasureOptions& options = {});

}  // namespace airtruth::separation
