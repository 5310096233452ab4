// SPDX-License-Identifier: Apache-2.0
#include "encounter/placement/near_miss.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "encounter/passage/passage.h"
#include "foundation/base/error.h"
#include "foundation/geometry/units.h"

namespace airtruth::placement {
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
    throw Error(fmt::format(
        "the intruder is {:.0f} m away at that moment; expected a smaller miss distance", range_m));
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
