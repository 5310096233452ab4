// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

namespace airtruth::placement {

// The path of an intruder that comes nearest to the own aircraft as a scene states it
// (docs/formats/scene.md, [intruder.encounter]). The path is straight, or a helix where it turns,
// and has neither start nor end.
//
// The own aircraft's position, velocity and course at cpa_time_s are those of `own`. Its course is
// that of course_rad() (encounter/passage/passage.h). "Right" and "ahead" are horizontal, "above"
// is vertical.
//
// The offset r of the intruder at its closest approach is across the relative velocity v: r . v =
// 0. This leaves two of the three numbers free. cpa_above_m and either cpa_right_m or cpa_ahead_m
// are taken as stated and the other one follows; where neither is stated, cpa_right_m is 0.
//
// Throws Error at the encounter's place where no path has that closest approach: it climbs faster
// than it flies, the own path does not reach cpa_time_s, both aircraft have the same velocity, the
// number that follows does not exist or is beyond kFarthestMissM, all three numbers are stated and
// lie more than kMissErrorM along the path from the closest approach, or the paths turn so that the
// distance there is not the least.
trajectory::Path path_to_approach(const scene::Encounter& encounter,
                                  const trajectory::Path& own,
                                  const trajectory::AttitudeOverride& attitude = {});

// The largest number that may follow, and the largest distance of three stated numbers from an
// approach.
constexpr double kFarthestMissM = 1e5;
constexpr double kMissErrorM = 0.01;

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
