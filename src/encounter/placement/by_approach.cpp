// SPDX-License-Identifier: Apache-2.0
#include "encounter/placement/by_approach.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "encounter/passage/passage.h"
#include "foundation/base/error.h"
#include "foundation/geometry/transform.h"

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

namespace {

// Largest number of rounds of each search. A straight own path needs two.
constexpr int kMaxRounds = 50;
// Smallest step of Newton's method.
constexpr double kStepS = 1e-9;

trajectory::State own_at(const trajectory::Path& own, double time_s) {
  const auto state = own.at(time_s);
  if (!state)
    throw Error(fmt::format(
        "the camera's path does not reach {:.1f} s, where the two would be nearest", time_s));
  return *state;
}

// The horizontal velocity whose path relative to the own aircraft leaves it `left_m` to the left of
// the line of sight. `off`: of the intruder from the own aircraft.
Vector3 velocity_past(const Vector3& off, const Vector3& own_mps, double left_m, double speed_mps) {
  const double range_m = std::hypot(off.x(), off.y());
  if (!(std::abs(left_m) < range_m))
    throw Error(
        fmt::format("the intruder is {:.0f} m away horizontally at that moment; expected a smaller "
                    "miss distance or an earlier moment",
                    range_m));
  const double course_rad = std::atan2(-off.y(), -off.x()) + std::asin(left_m / range_m);
  const Vector3 along(std::cos(course_rad), std::sin(course_rad), 0);
  const double own_along_mps = own_mps.dot(along);
  const double own_across_mps = own_mps.x() * along.y() - own_mps.y() * along.x();
  const double rest = (speed_mps - own_across_mps) * (speed_mps + own_across_mps);
  const double closing_mps = rest >= 0 ? std::sqrt(rest) - own_along_mps : -1;
  if (!(closing_mps > 0))
    throw Error(
        fmt::format("an intruder of {:.1f} m/s does not come near from there; expected a "
                    "higher speed",
                    speed_mps));
  return Vector3(own_mps.x(), own_mps.y(), 0) + closing_mps * along;
}

// The horizontal part of the miss distance.
double beside_m(const NearMiss& wanted, double above_m) {
  const double rest = (wanted.miss_m - above_m) * (wanted.miss_m + above_m);
  // Its own rounding is none of the height's.
  if (rest < -kMissM * kMissM)
    throw Error(fmt::format(
        "the intruder passes {:.0f} m {}; expected a miss distance of more than that, or "
        "another height",
        std::abs(above_m),
        above_m > 0 ? "above" : "below"));
  return std::sqrt(std::max(0.0, rest));
}

double ground_speed_mps(const NearMiss& wanted, double descent_mps) {
  const double rest = (wanted.speed_mps - descent_mps) * (wanted.speed_mps + descent_mps);
  if (!(rest > 0))
    throw Error(
        fmt::format("the intruder would {} at {:.0f} m/s; expected a higher speed than {}, "
                    "or another height",
                    descent_mps > 0 ? "descend" : "climb",
                    std::abs(descent_mps),
                    wanted.speed_mps));
  return std::sqrt(rest);
}

struct Passage {
  double time_s = 0;  // of the closest approach
  trajectory::State own;
  Vector3 off_m = Vector3::Zero();  // of the intruder from the own aircraft
};

// By Newton's method from `time_s`.
Passage nearest(const NearMiss& wanted,
                const Vector3& velocity_mps,
                double time_s,
                const trajectory::Path& own) {
  Passage passage{.time_s = time_s};
  for (int round = 0; round < kMaxRounds; ++round) {
    passage.own = own_at(own, passage.time_s);
    passage.off_m = wanted.place_ned_m + (passage.time_s - wanted.time_s) * velocity_mps -
                    passage.own.position_in_world;
    const Vector3 relative_mps = velocity_mps - passage.own.velocity_in_world_mps;
    const double step_s = -passage.off_m.dot(relative_mps) / relative_mps.squaredNorm();
    if (std::abs(step_s) <= kStepS) break;
    passage.time_s += step_s;
  }
  return passage;
}

scene::Encounter stated(const Passage& passage, const Vector3& velocity_mps) {
  const double own_course_rad = passage::course_rad(passage.own);
  const passage::Offset offset = passage::offset_from(passage.own, passage.off_m);
  const passage::Offset moves =
      passage::offset_from(passage.own, velocity_mps - passage.own.velocity_in_world_mps);
  scene::Encounter encounter;
  encounter.cpa_time_s = passage.time_s;
  // The other one follows, exactly where the relative path has a large part along it.
  if (std::abs(moves.ahead_m) >= std::abs(moves.right_m))
    encounter.cpa_right_m = offset.right_m;
  else
    encounter.cpa_ahead_m = offset.ahead_m;
  encounter.cpa_above_m = offset.above_m;
  encounter.course_deg = degrees(
      std::remainder(std::atan2(velocity_mps.y(), velocity_mps.x()) - own_course_rad, 2 * kPi));
  encounter.speed_mps = velocity_mps.norm();
  encounter.climb_mps = velocity_mps.z() == 0 ? 0 : -velocity_mps.z();
  return encounter;
}

}  // namespace

scene::Encounter encounter_of(const NearMiss& wanted, const trajectory::Path& own) {
  const trajectory::State begin = own_at(own, wanted.time_s);
  const Vector3 off_m = wanted.place_ned_m - begin.position_in_world;
  const bool is_ahead = passage::offset_from(begin, off_m).ahead_m >= 0;
  const double left = wanted.is_right == is_ahead ? -1 : 1;
  Vector3 own_mps = begin.velocity_in_world_mps;  // in the mean, up to the closest approach
  double descent_mps = 0;
  double aim_m = beside_m(wanted, wanted.above_m.value_or(-off_m.z()));
  for (int round = 0; round < kMaxRounds; ++round) {
    Vector3 velocity_mps =
        velocity_past(off_m, own_mps, left * aim_m, ground_speed_mps(wanted, descent_mps));
    velocity_mps.z() = descent_mps;
    const Vector3 relative_mps = velocity_mps - own_mps;
    const double guess_s = wanted.time_s - off_m.dot(relative_mps) / relative_mps.squaredNorm();
    const Passage passage = nearest(wanted, velocity_mps, guess_s, own);
    const double above_m = -passage.off_m.z();
    const double rise_m = wanted.above_m.value_or(above_m) - above_m;
    if (std::abs(wanted.miss_m - passage.off_m.norm()) <= kMissM && std::abs(rise_m) <= kMissM)
      return stated(passage, velocity_mps);
    aim_m += beside_m(wanted, wanted.above_m.value_or(above_m)) -
             std::hypot(passage.off_m.x(), passage.off_m.y());
    const double after_s = passage.time_s - wanted.time_s;
    own_mps = (passage.own.position_in_world - begin.position_in_world) / after_s;
    descent_mps -= rise_m / after_s;
  }
  throw Error(
      "no straight path from there passes at that distance, since the own aircraft turns; "
      "expected a moment that is nearer to the closest approach");
}

}  // namespace airtruth::placement
