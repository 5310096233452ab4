// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

namespace airtruth::placement {

// A straight path that goes through a place and then past the own aircraft.
struct NearMiss {
  // Where the intruder is at `time_s`.
  Vector3 place_ned_m = Vector3::Zero();
  double time_s = 0;
  // The distance at the closest approach, 0 and more, and on which side of the own course the
  // intruder is then.
  double miss_m = 0;
  bool is_right = true;
  double speed_mps = 0;  // along the path, climb included
  // How far above the own aircraft it is then; empty: it flies level.
  std::optional<double> above_m;
};

// The encounter whose path (path_to_approach()) goes through that place.
//
// Horizontally the path relative to the own aircraft is a tangent of a circle about it, whose
// radius follows from the miss distance and the height. Of the velocities along this tangent that
// have the stated speed, the one with the greatest closing speed is taken: a slow intruder then
// meets the own aircraft and does not follow it. Where the own aircraft turns or the intruder
// climbs, tangent and climb are moved until the closest approach has the miss distance and the
// height within kMissM.
//
// Throws Error, without a place: the intruder is nearer than the miss distance already, passes
// farther above or below, is too slow, or nothing settles; or the own path ends before.
scene::Encounter encounter_of(const NearMiss& wanted, const trajectory::Path& own);

constexpr double kMissM = 1e-3;

}  // namespace airtruth::placement
