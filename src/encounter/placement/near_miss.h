// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

namespace airtruth::placement {

// A level, straight path that goes through a place and then past the own aircraft.
struct NearMiss {
  // Where the intruder is at `time_s`.
  Vector3 place_ned_m = Vector3::Zero();
  double time_s = 0;
  // The horizontal distance at the closest approach, 0 and more, and on which side of the own
  // course the intruder is then.
  double miss_m = 0;
  bool is_right = true;
  double speed_mps = 0;
};

// The encounter whose path (path_to_approach()) goes through that place.
//
// Horizontally the path relative to the own aircraft is a tangent of the circle of the miss
// distance about it. Of the velocities along this tangent that have the stated speed, the one with
// the greatest closing speed is taken: a slow intruder then meets the own aircraft and does not
// follow it. Where the own aircraft turns on the way, the tangent is moved until the closest
// approach has the miss distance within kMissM.
//
// Throws Error, without a place: the intruder is nearer than the miss distance already, too slow to
// come so near, or no tangent settles; or the own path ends before.
scene::Encounter encounter_of(const NearMiss& wanted, const trajectory::Path& own);

constexpr double kMissM = 1e-3;

}  // namespace airtruth::placement
