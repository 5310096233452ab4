// SPDX-License-Identifier: Apache-2.0
#include "encounter/passage/passage.h"

#include <algorithm>
#include <cmath>

#include "foundation/geometry/horizon_dip.h"

namespace airtruth::passage {
namespace {

// Number of steps of a span: at kStep_s, those of 67 minutes.
constexpr int kMaxSteps = 200'000;
constexpr int kHalvings = 50;  // of a step: far below a microsecond

struct Both {
  trajectory::State own;
  trajectory::State intruder;

  separation::Relative between() const {
    return separation::relative(mover_of(own), mover_of(intruder));
  }
};

std::optional<Both> both_at(const trajectory::Path& own,
                            const trajectory::Path& intruder,
                            double time_s) {
  const auto a = own.at(time_s);
  const auto b = intruder.at(time_s);
  if (!a || !b) return std::nullopt;
  return Both{*a, *b};
}

// The times at which two paths are walked while both exist; empty where they never do.
std::vector<double> walked_times(const trajectory::Path& own,
                                 const trajectory::Path& intruder,
                                 double begin_s,
                                 double end_s) {
  begin_s = std::max({begin_s, own.start_s(), intruder.start_s()});
  end_s = std::min({end_s, own.end_s(), intruder.end_s()});
  if (!(begin_s <= end_s)) return {};
  const double span_s = end_s - begin_s;
  const int steps = std::clamp(
      static_cast<int>(std::min(std::ceil(span_s / kStep_s), 1e6)), span_s > 0 ? 1 : 0, kMaxSteps);
  std::vector<double> times_s;
  for (int i = 0; i <= steps; ++i)
    times_s.push_back(steps == 0 ? begin_s : begin_s + span_s * i / steps);
  return times_s;
}

// Between two times, the one at which `is_before` turns from true to false.
template <typename Condition>
double turning_point(double before_s, double after_s, const Condition& is_before) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle_s = 0.5 * (before_s + after_s);
    (is_before(middle_s) ? before_s : after_s) = middle_s;
  }
  return 0.5 * (before_s + after_s);
}

}  // namespace

separation::Mover mover_of(const trajectory::State& state) {
  return {state.position_in_world, state.velocity_in_world_mps};
}

double course_rad(const trajectory::State& own) {
  const Vector3& v = own.velocity_in_world_mps;
  if (std::hypot(v.x(), v.y()) >= kCourseMps) return std::atan2(v.y(), v.x());
  return radians(yaw_pitch_roll(own.world_from_body).yaw_deg);
}

Offset offset_from(const trajectory::State& own, const Vector3& offset_ned_m) {
  const double course = course_rad(own);
  const Vector3& r = offset_ned_m;
  return {std::cos(course) * r.x() + std::sin(course) * r.y(),
          -std::sin(course) * r.x() + std::cos(course) * r.y(),
          -r.z()};
}

trajectory::Path beyond_clip(const trajectory::Path& path, double clip_end_s) {
  const double end_s = path.end_s();
  // The path tells whether its end is that of the clip, whose time is rounded to a stream's clock.
  if (!std::isfinite(end_s) || !path.at(std::max(clip_end_s, path.start_s()))) return path;
  return trajectory::straight_on(path, path.start_s(), HUGE_VAL);
}

std::optional<Approach> closest_approach(const trajectory::Path& own,
                                         const trajectory::Path& intruder,
                                         double begin_s,
                                         double end_s) {
  const std::vector<double> times_s = walked_times(own, intruder, begin_s, end_s);
  if (times_s.empty()) return std::nullopt;
  std::size_t best = 0;
  double least_m = HUGE_VAL, greatest_m = 0;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const auto both = both_at(own, intruder, times_s[i]);
    if (!both) continue;
    const double distance_m = both->between().offset_ned_m.norm();
    greatest_m = std::max(greatest_m, distance_m);
    if (distance_m < least_m) {
      least_m = distance_m;
      best = i;
    }
  }
  const bool is_kept = times_s.size() > 1 && greatest_m - least_m < kSameDistance_m;
  const auto is_closing = [&](double t, double least_mps) {
    const auto both = both_at(own, intruder, t);
    if (!both) return false;
    const separation::Relative between = both->between();
    return between.offset_ned_m.dot(between.velocity_ned_mps) <
           -least_mps * between.offset_ned_m.norm();
  };
  // Around the nearest step the distance falls and then rises.
  const double before_s = times_s[best > 0 ? best - 1 : 0];
  const double after_s = times_s[std::min(best + 1, times_s.size() - 1)];
  const double time_s =
      is_kept ? times_s.front()
              : turning_point(before_s, after_s, [&](double t) { return is_closing(t, 0); });
  const auto both = both_at(own, intruder, time_s);
  if (!both) return std::nullopt;
  const Vector3 offset = both->between().offset_ned_m;
  return Approach{time_s,
                  offset.norm(),
                  std::hypot(offset.x(), offset.y()),
                  offset_from(both->own, offset),
                  best + 1 == times_s.size() && is_closing(times_s.back(), separation::kStillMps),
                  is_kept};
}

std::vector<separation::Interval> violations(const separation::Volume& volume,
                                             const trajectory::Path& own,
                                             const trajectory::Path& intruder,
                                             double begin_s,
                                             double end_s) {
  std::vector<double> times_s = walked_times(own, intruder, begin_s, end_s);
  if (const auto nearest = closest_approach(own, intruder, begin_s, end_s))
    times_s.insert(std::ranges::upper_bound(times_s, nearest->time_s), nearest->time_s);
  const auto inside = [&](double time_s) {
    const auto both = both_at(own, intruder, time_s);
    return both && separation::is_inside(volume, mover_of(both->own), mover_of(both->intruder));
  };
  std::vector<separation::Interval> result;
  bool was_inside = false;
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const bool is_now = inside(times_s[i]);
    if (is_now && !was_inside) {
      const double entry_s =
          i == 0 ? times_s[0]
                 : turning_point(times_s[i - 1], times_s[i], [&](double t) { return !inside(t); });
      result.push_back({entry_s, times_s.back()});
    }
    if (!is_now && was_inside)
      result.back().end_s = turning_point(times_s[i - 1], times_s[i], inside);
    was_inside = is_now;
  }
  return result;
}

std::optional<Meeting> meeting_of(const separation::Mover& own, const separation::Mover& intruder) {
  const Eigen::Vector2d a = own.velocity_ned_mps.head<2>();
  const Eigen::Vector2d b = intruder.velocity_ned_mps.head<2>();
  if (a.norm() < kCourseMps || b.norm() < kCourseMps) return std::nullopt;
  const double right_deg = degrees(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
  if (std::abs(right_deg) >= kHeadOnDeg) return Meeting::kHeadOn;
  if (std::abs(right_deg) >= kOvertakingDeg)
    return right_deg > 0 ? Meeting::kCrossingFromLeft : Meeting::kCrossingFromRight;
  const double faster_mps = a.norm() - b.dot(a.normalized());
  if (std::abs(faster_mps) < separation::kStillMps) return std::nullopt;
  return faster_mps > 0 ? Meeting::kOvertaking : Meeting::kOvertaken;
}

VerticalMotion vertical_motion_of(const separation::Mover& intruder) {
  const double climb_mps = -intruder.velocity_ned_mps.z();
  if (climb_mps >= kClimbingMps) return VerticalMotion::kClimbing;
  return climb_mps <= -kClimbingMps ? VerticalMotion::kDescending : VerticalMotion::kLevel;
}

AgainstHorizon against_horizon(const separation::Mover& own,
                               const separation::Mover& intruder,
                               double half_height_deg) {
  const double above_deg = degrees(above_horizon_rad(intruder.position_ned_m, own.position_ned_m));
  if (std::abs(above_deg) <= half_height_deg) return AgainstHorizon::kOn;
  return above_deg > 0 ? AgainstHorizon::kAbove : AgainstHorizon::kBelow;
}

}  // namespace airtruth::passage
