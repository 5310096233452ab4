// SPDX-License-Identifier: Apache-2.0
#include "encounter/pairing/geometric.h"

#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::pairing {
namespace {

enum Dimension { kCourse, kSpeed, kHmd, kVmd, kClimb, kTurn, kTime, kDimensions };

// sin(x) / x and (1 - cos(x)) / x, which have no value of their own at 0.
double sine_ratio(double x) { return std::abs(x) < 1e-9 ? 1 : std::sin(x) / x; }
double versine_ratio(double x) {
  const double half = std::sin(x / 2);
  return std::abs(x) < 1e-9 ? x / 2 : 2 * half * half / x;
}

}  // namespace

GeometricSampler::GeometricSampler(const GeometricOptions& options,
                                   std::uint64_t seed,
                                   std::uint64_t count)
    : options_(options), strata_(seed, count < 1 ? 1 : count, kDimensions) {
  if (count < 1) throw Error("0 encounters are asked for; expected 1 or more");
  if (options.speed_mps.low() < 0)
    throw Error(fmt::format("speed_mps begins at {}; expected 0 or more", options.speed_mps.low()));
}

Geometry GeometricSampler::draw(std::uint64_t index) const {
  const auto value = [&](const Distribution& distribution, Dimension dimension) {
    return distribution.quantile(strata_.at(index, dimension));
  };
  return {.approach = {.time_s = value(options_.cpa_time_s, kTime),
                       .course_deg = value(options_.course_deg, kCourse),
                       .hmd_m = value(options_.hmd_m, kHmd),
                       .vmd_m = value(options_.vmd_m, kVmd)},
          .speed_mps = value(options_.speed_mps, kSpeed),
          .climb_mps = value(options_.climb_mps, kClimb),
          .turn_rate_dps = value(options_.turn_rate_dps, kTurn)};
}

track::Track geometric_track(const track::Track& own,
                             const Geometry& geometry,
                             double begin_s,
                             double end_s) {
  const double cpa_s = geometry.approach.time_s;
  if (!(begin_s <= cpa_s && cpa_s <= end_s && begin_s < end_s))
    throw Error(fmt::format(
        "the closest approach at {} s is outside of {} to {} s", cpa_s, begin_s, end_s));
  track::Track track{"intruder", {}, {}, {}};
  const auto add = [&](double time_s) {
    // North at the closest approach; place() turns the whole track.
    const double t = time_s - cpa_s;
    const double turned = radians(geometry.turn_rate_dps) * t;
    const double flown = geometry.speed_mps * t;
    track.times_s.push_back(time_s);
    track.positions_ned_m.emplace_back(
        flown * sine_ratio(turned), flown * versine_ratio(turned), -geometry.climb_mps * t);
    track.velocities_ned_mps.emplace_back(geometry.speed_mps * std::cos(turned),
                                          geometry.speed_mps * std::sin(turned),
                                          -geometry.climb_mps);
  };
  for (int i = 0; begin_s + i < end_s; ++i) add(begin_s + i);
  add(end_s);
  place(track, own, geometry.approach);
  return track;
}

}  // namespace airtruth::pairing
