// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "encounter/passage/passage.h"
#include "foundation/base/enum_names.h"

// What kind of encounter two states are.
namespace airtruth::encounter {

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
std::optional<Meeting> meeting_of(const Mover& own, const Mover& intruder);

enum class VerticalMotion { kClimbing, kLevel, kDescending };
constexpr auto enum_names(VerticalMotion) {
  return std::to_array<EnumName<VerticalMotion>>({{VerticalMotion::kClimbing, "climbing"},
                                                  {VerticalMotion::kLevel, "level"},
                                                  {VerticalMotion::kDescending, "descending"}});
}
// A climb of 500 ft/min and more is climbing, as TCAS II shows it by an arrow (RTCA DO-185B).
constexpr double kClimbingMps = 500 * kMetresPerFoot / 60;
VerticalMotion vertical_motion_of(const Mover& intruder);

// Where an intruder stands against the horizon of level ground.
enum class AgainstHorizon { kBelow, kOn, kAbove };
constexpr auto enum_names(AgainstHorizon) {
  return std::to_array<EnumName<AgainstHorizon>>({{AgainstHorizon::kBelow, "below"},
                                                  {AgainstHorizon::kOn, "on"},
                                                  {AgainstHorizon::kAbove, "above"}});
}
// The angle by which the horizon lies below the level at a height above the ground (0 and below:
// 0), on a sphere of the Earth's mean radius, without refraction.
double horizon_dip_deg(double height_m);
// `half_height_deg`: half of the angle that the intruder takes up vertically. It is on the horizon
// where the horizon crosses it. The ground is at down = 0.
AgainstHorizon against_horizon(const Mover& own, const Mover& intruder, double half_height_deg);

}  // namespace airtruth::encounter
