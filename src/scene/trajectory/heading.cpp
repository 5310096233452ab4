// SPDX-License-Identifier: Apache-2.0
#include "scene/trajectory/heading.h"

#include <algorithm>
#include <cmath>

#include "foundation/geometry/units.h"

namespace airtruth::trajectory {
namespace {

// Greatest rate of a turn on the spot, in degrees a second, where there is time: a choice.
constexpr double kOnTheSpotDps = 30;
// Number of equal parts between two times.
constexpr int kPartsOfStep = 16;
// Halvings or thirds of a part: down to the resolution of a time.
constexpr int kNarrowings = 60;

double over_ground(const Vector3& v) { return std::hypot(v.x(), v.y()); }

}  // namespace

bool Heading::is_slow(const Vector3& velocity_mps) const {
  return over_ground(velocity_mps) <= std::max(least_mps_, 1e-9 * velocity_mps.norm());
}

std::optional<double> Heading::held_deg_at(double time_s) const {
  std::call_once(once_, [this] { look(); });
  const auto after = std::ranges::upper_bound(slow_, time_s, {}, &Slow::begin_s);
  // One that is shorter than a part, without a reversal.
  if (after == slow_.begin() || time_s > (after - 1)->end_s) return direction_deg(time_s);
  const Slow& slow = *(after - 1);
  if (!slow.before_deg || !slow.after_deg)
    return slow.before_deg ? slow.before_deg : slow.after_deg;
  const double turn_deg = nearest_turn(*slow.after_deg, *slow.before_deg) - *slow.before_deg;
  // A smooth step is 1.5 times as fast in its middle as on average.
  const double turn_s =
      std::min(slow.end_s - slow.begin_s, 1.5 * std::abs(turn_deg) / kOnTheSpotDps);
  const double left_s = slow.end_s - time_s;
  if (left_s >= turn_s) return slow.before_deg;
  const double share = 1 - left_s / turn_s;
  return *slow.before_deg + turn_deg * share * share * (3 - 2 * share);
}

void Heading::look() const {
  double last_s = times_s_.front();
  bool was_slow = is_slow(velocity_(last_s));
  if (was_slow) slow_.push_back({last_s, times_s_.back(), {}, {}});
  const auto go_to = [&](double time_s) {
    const bool is_now = is_slow(velocity_(time_s));
    if (is_now && !was_slow) {
      const double begin_s = edge_s(last_s, time_s);
      slow_.push_back({begin_s, times_s_.back(), direction_deg(begin_s), {}});
    }
    if (!is_now && was_slow) {
      slow_.back().end_s = edge_s(time_s, last_s);
      slow_.back().after_deg = direction_deg(slow_.back().end_s);
    }
    was_slow = is_now;
    last_s = time_s;
  };
  for (std::size_t i = 1; i < times_s_.size(); ++i) {
    const double begin_s = times_s_[i - 1];
    for (int part = 1; part <= kPartsOfStep; ++part) {
      const double time_s = begin_s + (times_s_[i] - begin_s) * part / kPartsOfStep;
      // A reversal may be slow for less than a part.
      if (velocity_(last_s).head<2>().dot(velocity_(time_s).head<2>()) < 0)
        go_to(slowest_s(last_s, time_s));
      go_to(time_s);
    }
  }
}

double Heading::direction_deg(double time_s) const {
  const Vector3 v = velocity_(time_s);
  return degrees(std::atan2(v.y(), v.x()));
}

// Between a time at which it is not slow and one at which it is, the last of the former kind.
double Heading::edge_s(double fast_s, double slow_s) const {
  for (int i = 0; i < kNarrowings; ++i) {
    const double middle_s = 0.5 * (fast_s + slow_s);
    (is_slow(velocity_(middle_s)) ? slow_s : fast_s) = middle_s;
  }
  return fast_s;
}

double Heading::slowest_s(double begin_s, double end_s) const {
  for (int i = 0; i < kNarrowings; ++i) {
    const double third_s = (end_s - begin_s) / 3;
    if (over_ground(velocity_(begin_s + third_s)) < over_ground(velocity_(end_s - third_s)))
      end_s -= third_s;
    else
      begin_s += third_s;
  }
  return 0.5 * (begin_s + end_s);
}

}  // namespace airtruth::trajectory
