// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "encounter/separation/violation.h"
#include "scene/trajectory/path.h"

// The encounter of two whole paths, between frames too. Times are on the clock of the paths.
namespace airtruth::encounter {

Mover mover_of(const trajectory::State& state);

// Where an offset lies as the own aircraft's crew would say it: along the own course, right of it
// (both level) and above. The course is that of the velocity over the ground, or the heading of the
// attitude below kCourseMps.
struct Offset {
  double ahead_m = 0;
  double right_m = 0;
  double above_m = 0;
};
constexpr double kCourseMps = 0.1;
double course_rad(const trajectory::State& own);
Offset offset_from(const trajectory::State& own, const Vector3& offset_ned_m);

struct Approach {
  double time_s = 0;
  double distance_m = 0;
  double horizontal_m = 0;
  Offset offset;  // of the intruder from the own aircraft
};

// The least distance in space between begin_s and end_s while both are in the world. Empty where
// they never are. The time is exact to a microsecond where the paths are smooth over kStep_s.
std::optional<Approach> closest_approach(const trajectory::Path& own,
                                         const trajectory::Path& intruder,
                                         double begin_s,
                                         double end_s);

// The intervals between begin_s and end_s in which the states of the paths violate the volume
// (is_inside), in order. A violation that is shorter than kStep_s, or a pause in one, may be
// missed, unless it holds the closest approach.
std::vector<Interval> violations(const Volume& volume,
                                 const trajectory::Path& own,
                                 const trajectory::Path& intruder,
                                 double begin_s,
                                 double end_s);

// The step at which paths are walked; longer for spans above an hour.
constexpr double kStep_s = 0.02;

}  // namespace airtruth::encounter
