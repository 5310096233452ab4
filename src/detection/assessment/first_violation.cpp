// SPDX-License-Identifier: Apache-2.0
#include "detection/assessment/first_violation.h"

#include "encounter/separation/violation.h"

namespace airtruth::detection {
namespace {

constexpr int kHalvings = 40;

encounter::Mover between(const encounter::Mover& a, const encounter::Mover& b, double share) {
  return {a.position_ned_m + share * (b.position_ned_m - a.position_ned_m),
          a.velocity_ned_mps + share * (b.velocity_ned_mps - a.velocity_ned_mps)};
}

// `before` does not violate the volume and `after` does.
double entry_s(const encounter::Volume& volume, const PairState& before, const PairState& after) {
  double low = 0;
  double high = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double share = (low + high) / 2;
    const bool is_in = is_inside(volume,
                                 between(before.own, after.own, share),
                                 between(before.intruder, after.intruder, share));
    (is_in ? high : low) = share;
  }
  return before.time_s + high * (after.time_s - before.time_s);
}

}  // namespace

std::optional<double> first_violation_s(const encounter::Volume& volume,
                                        std::span<const PairState> states,
                                        double lookahead_s) {
  for (std::size_t i = 0; i < states.size(); ++i)
    if (is_inside(volume, states[i].own, states[i].intruder))
      return i == 0 ? states[i].time_s : entry_s(volume, states[i - 1], states[i]);
  if (states.empty()) return std::nullopt;
  const PairState& last = states.back();
  const auto later = encounter::violation(volume, last.own, last.intruder, lookahead_s);
  return later ? std::optional(last.time_s + later->begin_s) : std::nullopt;
}

}  // namespace airtruth::detection
