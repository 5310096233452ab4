// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <airtruth/truth.h>

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

// The measures of a frame's truth without its volumes, and the distance in space. A measure that is
// not defined is empty (docs/formats/truth.md); no measure is ever NaN or infinite.
struct Measures : EncounterTruth {
  double range_m = 0;
};

Measures measures(const Mover& own, const Mover& intruder, const MeasureOptions& options = {});

}  // namespace airtruth::separation
