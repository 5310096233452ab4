// SPDX-License-Identifier: Apache-2.0
#include "encounter/placement/by_approach.h"

#include <cmath>

#include <fmt/format.h>

#include "encounter/passage/passage.h"
#include "foundation/base/error.h"

namespace airtruth::placement {
namespace {

// Slower relative motion is none, in m/s.
constexpr double kSameVelocityMps = 1e-6;
// A part of the relative velocity below this share of it is none: the number that follows from it
// would be a thousand million times the stated ones.
constexpr double kPartShare = 1e-9;
// Half the interval over which a closest approach is told from a farthest one.
constexpr double kNear_s = 0.05;

// In world, from ahead, right, above of the own course.
Vector3 in_world(const Vector3& v, double course_rad) {
  const double c = std::cos(course_rad);
  const double s = std::sin(course_rad);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), -v.z()};
}

trajectory::State own_at_approach(const scene::Encounter& encounter, const trajectory::Path& own) {
  if (const auto state = own.at(encounter.cpa_time_s)) return *state;
  throw Error(
      fmt::format("cpa_time_s is {:.3f}, but the camera's path goes from {:.3f} to {:.3f} s; "
                  "expected a time within it",
                  encounter.cpa_time_s,
                  own.start_s(),
                  own.end_s()),
      encounter.where);
}

// The offset's part along one axis (`follows`: 0 ahead, 1 right) that makes the offset
// perpendicular to the velocity; both in ahead, right, above.
double following_part(const scene::Encounter& encounter,
                      const Vector3& offset,
                      const Vector3& velocity,
                      int follows) {
  const char* const key = follows == 0 ? "cpa_ahead_m" : "cpa_right_m";
  const char* const stated = follows == 0 ? "cpa_right_m" : "cpa_ahead_m";
  Vector3 rest = offset;
  rest[follows] = 0;
  const double along = rest.dot(velocity);
  if (std::abs(along) <= kPartShare * velocity.norm()) return 0;
  if (std::abs(velocity[follows]) <= kPartShare * velocity.norm())
    throw Error(fmt::format("no closest approach has this {} and cpa_above_m, whatever its {}: the "
                            "intruder does not move {} relative to the own aircraft; expected "
                            "{} in place of {}",
                            stated,
                            key,
                            follows == 0 ? "ahead or back" : "sideways",
                            key,
                            stated),
                encounter.where);
  const double part_m = -along / velocity[follows];
  if (std::abs(part_m) > kFarthestMissM)
    throw Error(fmt::format("a closest approach with this {} and cpa_above_m has a {} of {:.0f}; "
                            "expected numbers with which it is within {:.0f} m, or {} in place of "
                            "{}",
                            stated,
                            key,
                            part_m,
                            kFarthestMissM,
                            key,
                            stated),
                encounter.where);
  return part_m;
}

// In ahead, right, above.
Vector3 velocity_of(const scene::Encounter& encounter) {
  const double speed_mps = encounter.speed_mps;
  const double climb_mps = encounter.climb_mps;
  if (!(std::abs(climb_mps) <= speed_mps))
    throw Error(fmt::format("climb_mps is {} at a speed_mps of {:.1f}; expected no more than the "
                            "speed",
                            climb_mps,
                            speed_mps),
                encounter.where);
  const double ground_speed_mps = std::sqrt((speed_mps - climb_mps) * (speed_mps + climb_mps));
  const double turned_rad = radians(encounter.course_deg);
  return {
      ground_speed_mps * std::cos(turned_rad), ground_speed_mps * std::sin(turned_rad), climb_mps};
}

// How far the stated place lies from the closest approach, along the relative path.
void refuse_contradiction(const scene::Encounter& encounter,
                          const Vector3& offset,
                          const Vector3& velocity) {
  const double off_m = offset.dot(velocity) / velocity.norm();
  if (std::abs(off_m) <= kMissErrorM) return;
  throw Error(
      fmt::format("cpa_right_m, cpa_above_m and cpa_ahead_m are no closest approach at "
                  "these velocities: the nearest place is {:.2f} m {} on the relative path, "
                  "{:.2f} s {}; expected cpa_right_m or cpa_ahead_m alone, from which the "
                  "other follows",
                  std::abs(off_m),
                  off_m > 0 ? "back" : "further",
                  std::abs(off_m) / velocity.norm(),
                  off_m > 0 ? "earlier" : "later"),
      encounter.where);
}

// In ahead, right, above.
Vector3 offset_of(const scene::Encounter& encounter, const Vector3& velocity) {
  Vector3 offset(
      encounter.cpa_ahead_m.value_or(0), encounter.cpa_right_m.value_or(0), encounter.cpa_above_m);
  if (encounter.cpa_ahead_m && encounter.cpa_right_m)
    refuse_contradiction(encounter, offset, velocity);
  else if (encounter.cpa_ahead_m)
    offset.y() = following_part(encounter, offset, velocity, 1);
  else
    offset.x() = following_part(encounter, offset, velocity, 0);
  return offset;
}

// Where one of the paths turns, a place with r . v = 0 may be the farthest one nearby.
void refuse_farthest(const scene::Encounter& encounter,
                     const trajectory::Path& path,
                     const trajectory::Path& own) {
  const auto distance_m = [&](double time_s) -> std::optional<double> {
    const auto a = own.at(time_s);
    const auto b = path.at(time_s);
    if (!a || !b) return std::nullopt;
    return (b->position_in_world - a->position_in_world).norm();
  };
  const double here_m = distance_m(encounter.cpa_time_s).value_or(0);
  // Far from the origin a double holds a position less exactly.
  const double tolerance_m = 1e-6 + 1e-12 * own.at(encounter.cpa_time_s)->position_in_world.norm();
  for (const double step_s : {-kNear_s, kNear_s}) {
    const auto there_m = distance_m(encounter.cpa_time_s + step_s);
    if (there_m && *there_m < here_m - tolerance_m)
      throw Error(
          fmt::format("the paths turn so that the two are nearer just {} cpa_time_s = {:.3f}: "
                      "{:.2f} m instead of {:.2f} m; expected a smaller miss distance or a "
                      "slower turn",
                      step_s < 0 ? "before" : "after",
                      encounter.cpa_time_s,
                      *there_m,
                      here_m),
          encounter.where);
  }
}

}  // namespace

trajectory::Path path_to_approach(const scene::Encounter& encounter,
                                  const trajectory::Path& own,
                                  const trajectory::AttitudeOverride& attitude) {
  const trajectory::State own_then = own_at_approach(encounter, own);
  const double course_rad = passage::course_rad(own_then);
  const Vector3 velocity = velocity_of(encounter);
  const auto [ahead_mps, right_mps, up_mps] =
      passage::offset_from(own_then, own_then.velocity_in_world_mps);
  const Vector3 relative = velocity - Vector3(ahead_mps, right_mps, up_mps);
  if (!(relative.norm() > kSameVelocityMps))
    throw Error(
        "the intruder has the velocity of the own aircraft at cpa_time_s, so that they stay "
        "as far apart as they are; expected another course_deg, speed_mps or climb_mps",
        encounter.where);
  const Vector3 offset = offset_of(encounter, relative);
  const trajectory::Path path = trajectory::steady(
      {.position_ned_m = own_then.position_in_world + in_world(offset, course_rad),
       .time_s = encounter.cpa_time_s,
       .course_deg = degrees(course_rad) + encounter.course_deg,
       .ground_speed_mps = std::hypot(velocity.x(), velocity.y()),
       .climb_mps = encounter.climb_mps,
       .turn_rate_dps = encounter.turn_rate_dps},
      attitude);
  refuse_farthest(encounter, path, own);
  return path;
}

}  // namespace airtruth::placement
