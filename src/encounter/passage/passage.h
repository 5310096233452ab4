// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "encounter/separation/violation.h"
#include "foundation/base/names.h"
#include "foundation/geometry/units.h"
#include "scene/trajectory/heading.h"
#include "scene/trajectory/path.h"

// The encounter of two whole paths, between frames too. Times are on the clock of the paths.
namespace airtruth::passage {

separation::Mover mover_of(const trajectory::State& state);

// Where an offset lies as the own aircraft's crew would say it: along the own course, right of it
// (both level) and above. The course is that of the velocity over the ground, or the heading of the
// attitude below kCourseMps.
struct Offset {
  double ahead_m = 0;
  double right_m = 0;
  double above_m = 0;
};
using trajectory::kCourseMps;
double course_rad(const trajectory::State& own);
Offset offset_from(const trajectory::State& own, const Vector3& offset_ned_m);

struct Approach {
  double time_s = 0;
  double distance_m = 0;
  double horizontal_m = 0;
  Offset offset;  // of the intruder from the own aircraft
  // True where a path, or the time asked for, ends while the two still come nearer.
  bool is_cut_off = false;
  // True where the two keep their distance within kSameDistance_m, as in formation: the moment is
  // then the first one.
  bool is_kept = false;
};
// Chosen far above what rounding makes of equal distances.
constexpr double kSameDistance_m = 1e-6;

// The path of a clip's aircraft in the time after the clip: from its own end on, one that lasts
// until the clip's end goes straight on as it moves there; one that ends within the clip is over.
trajectory::Path beyond_clip(const trajectory::Path& path, double clip_end_s);

// The least distance in space between begin_s and end_s while both are in the world. Empty where
// they never are. The time is exact to a microsecond where the paths are smooth over kStep_s.
std::optional<Approach> closest_approach(const trajectory::Path& own,
                                         const trajectory::Path& intruder,
                                         double begin_s,
                                         double end_s);

// The intervals between begin_s and end_s in which the states of the paths violate the volume
// (is_inside), in order. A violation that is shorter than kStep_s, or a pause in one, may be
// missed, unless it holds the closest approach.
std::vector<separation::Interval> violations(const separation::Volume& volume,
                                             const trajectory::Path& own,
                                             const trajectory::Path& intruder,
                                             double begin_s,
                                             double end_s);

// The step at which paths are walked; longer for spans above an hour.
constexpr double kStep_s = 0.02;

// What kind of encounter two states are.

// How the courses over the ground meet, seen from the own aircraft.
enum class Meeting { kHeadOn, kCrossingFromLeft, kCrossingFromRight, kOvertaking, kOvertaken };
constexpr auto enum_names(Meeting) {
  return std::to_array<EnumName<Meeting>>({{Meeting::kHeadOn, "head-on"},
                                           {Meeting::kCrossingFromLeft, "crossing from left"},
                                           {Meeting::kCrossingFromRight, "crossing from right"},
                                           {Meeting::kOvertaking, "overtaking"},
                                           {Meeting::kOvertaken, "overtaken"}});
}

// Courses that differ by less than 70 degrees are one overtaking the other: the rear sector of the
// rules of the air (ICAO Annex 2, 3.2.2.4). Courses within 30 degrees of opposite are head-on ("or
// approximately so", 3.2.2.2, states no number).
constexpr double kOvertakingDeg = 70;
constexpr double kHeadOnDeg = 150;

// Of the states at the closest approach. `overtaking`: the own aircraft is the faster of the two
// along its course; `overtaken`: the intruder is. Empty where one of them moves over the ground at
// less than kCourseMps, or both are equally fast on the same course.
std::optional<Meeting> meeting_of(const separation::Mover& own, const separation::Mover& intruder);

enum class VerticalMotion { kClimbing, kLevel, kDescending };
constexpr auto enum_names(VerticalMotion) {
  return std::to_array<EnumName<VerticalMotion>>({{VerticalMotion::kClimbing, "climbing"},
                                                  {VerticalMotion::kLevel, "level"},
                                                  {VerticalMotion::kDescending, "descending"}});
}
// A climb of 500 ft/min and more is climbing, as TCAS II shows it by an arrow (RTCA DO-185B).
constexpr double kClimbingMps = 500 * kMpsOfFootPerMinute;
VerticalMotion vertical_motion_of(const separation::Mover& intruder);

// Where an intruder stands against the horizon of level ground.
enum class AgainstHorizon { kBelow, kOn, kAbove };
constexpr auto enum_names(AgainstHorizon) {
  return std::to_array<EnumName<AgainstHorizon>>({{AgainstHorizon::kBelow, "below"},
                                                  {AgainstHorizon::kOn, "on"},
                                                  {AgainstHorizon::kAbove, "above"}});
}
// `half_height_deg`: half of the angle that the intruder takes up vertically. It is on the horizon
// where the horizon crosses it. The ground is at down = 0.
AgainstHorizon against_horizon(const separation::Mover& own,
                               const separation::Mover& intruder,
                               double half_height_deg);

}  // namespace airtruth::passage
