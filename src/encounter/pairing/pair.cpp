// SPDX-License-Identifier: Apache-2.0
#include "encounter/pairing/pair.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"

namespace airtruth::pairing {

Distribution::Distribution(std::vector<double> edges,
                           std::vector<double> shares,
                           const std::string& name)
    : edges_(std::move(edges)) {
  const auto is_finite = [](double number) { return std::isfinite(number); };
  if (edges_.empty() || !std::ranges::all_of(edges_, is_finite) ||
      std::ranges::adjacent_find(edges_, std::greater_equal<>()) != edges_.end())
    throw Error(fmt::format("{} is {}; expected one number, or the increasing edges of bins",
                            name,
                            fmt::join(edges_, " ")));
  if (shares.empty())
    for (std::size_t bin = 0; bin + 1 < edges_.size(); ++bin)
      shares.push_back(edges_[bin + 1] - edges_[bin]);
  if (shares.size() + 1 != edges_.size())
    throw Error(fmt::format("{} has {} shares for {} edges; expected one for each bin",
                            name,
                            shares.size(),
                            edges_.size()));
  double sum = 0;
  for (const double share : shares) {
    if (!std::isfinite(share) || share < 0)
      throw Error(fmt::format("{} has a share of {}; expected 0 or more", name, share));
    sums_.push_back(sum += share);
  }
  if (!shares.empty() && !(sum > 0 && std::isfinite(sum)))
    throw Error(fmt::format("{} has shares that sum to {}; expected more than 0", name, sum));
  for (double& running : sums_) running /= sum;
}

double Distribution::quantile(double u) const {
  if (sums_.empty()) return edges_.front();
  // The first bin whose sum exceeds u has a share above 0.
  auto bin = static_cast<std::size_t>(std::ranges::upper_bound(sums_, u) - sums_.begin());
  if (bin == sums_.size())
    bin = static_cast<std::size_t>(std::ranges::lower_bound(sums_, 1.0) - sums_.begin());
  const double before = bin == 0 ? 0 : sums_[bin - 1];
  const double within = std::min(1.0, (u - before) / (sums_[bin] - before));
  return edges_[bin] + (edges_[bin + 1] - edges_[bin]) * within;
}

double Distribution::density(double value) const {
  if (sums_.empty()) return value == edges_.front() ? HUGE_VAL : 0;
  if (value < low() || value > high()) return 0;
  const auto above = std::upper_bound(edges_.begin(), edges_.end() - 1, value);
  const auto bin = static_cast<std::size_t>(above - edges_.begin()) - 1;
  const double before = bin == 0 ? 0 : sums_[bin - 1];
  return (sums_[bin] - before) / (edges_[bin + 1] - edges_[bin]);
}

namespace {

using track::Track;

// Number of draws of an approach or a geometry: it ends a search among tracks that circle.
constexpr int kMaxDraws = 100;
// Of courses: the acceptance is at least one in 1.6 where the speeds are equal.
constexpr int kMaxCourses = 1000;
// Below it the direction of the relative velocity is not defined.
constexpr double kMinRelativeSpeed_mps = 0.1;

// North and east.
using Vector2 = Eigen::Vector2d;

double course_rad(const Vector3& velocity_ned) {
  return std::atan2(velocity_ned.y(), velocity_ned.x());
}

track::TrackState state_of(const Track& track, double time_s) {
  if (track.size() < 2)
    throw Error(fmt::format("the track '{}' has one sample; expected two or more", track.name));
  if (time_s < track.times_s.front() || time_s > track.times_s.back())
    throw Error(fmt::format("the closest approach at {} s is outside of the track '{}', {} to {} s",
                            time_s,
                            track.name,
                            track.times_s.front(),
                            track.times_s.back()));
  return track::state_at(track, time_s);
}

// Both ends of a segment on which both tracks are straight.
double least_on_segment(const Vector2& from, const Vector2& to) {
  const Vector2 step = to - from;
  const double square = step.squaredNorm();
  const double share = square > 0 ? std::clamp(-from.dot(step) / square, 0.0, 1.0) : 0.0;
  return (from + share * step).norm();
}

Vector3 on_line(const Track& track, std::size_t& i, double time_s) {
  while (i + 2 < track.size() && track.times_s[i + 1] <= time_s) ++i;
  const double share = (time_s - track.times_s[i]) / (track.times_s[i + 1] - track.times_s[i]);
  return track.positions_ned_m[i] +
         share * (track.positions_ned_m[i + 1] - track.positions_ned_m[i]);
}

// Relative course in radians; empty where no draw is accepted.
std::optional<double> drawn_course_rad(const Vector3& own,
                                       const Vector3& intruder,
                                       Random& random) {
  const double a = own.head<2>().norm(), b = intruder.head<2>().norm();
  const double climb = intruder.z() - own.z();
  const double fastest = std::hypot(a + b, climb);
  for (int i = 0; i < kMaxCourses; ++i) {
    const double course = kPi * (2 * random.uniform() - 1);
    const double along = b * std::cos(course) - a, across = b * std::sin(course);
    const double relative = std::hypot(along, across, climb);
    if (random.uniform() * fastest < relative && std::hypot(along, across) > kMinRelativeSpeed_mps)
      return course;
  }
  return std::nullopt;
}

// How much denser uniform traffic is at a distance than the distribution that it was drawn from.
double density_ratio(const Distribution& drawn, double distance_m) {
  const double farthest = std::max(std::abs(drawn.low()), std::abs(drawn.high()));
  return 1 / (2 * farthest) / drawn.density(distance_m);
}

}  // namespace

void place(Track& intruder, const Track& own, const ClosestApproach& approach) {
  const track::TrackState a = state_of(own, approach.time_s);
  const track::TrackState b = state_of(intruder, approach.time_s);
  const double own_course = course_rad(a.velocity_ned_mps);
  const double course = own_course + radians(approach.course_deg);
  const Vector2 velocity =
      b.velocity_ned_mps.head<2>().norm() * Vector2(std::cos(course), std::sin(course));
  Vector2 relative = velocity - a.velocity_ned_mps.head<2>();
  if (relative.norm() < kMinRelativeSpeed_mps)
    relative = -Vector2(std::cos(own_course), std::sin(own_course));
  const Vector2 offset = approach.hmd_m * Vector2(relative.y(), -relative.x()).normalized();
  const Vector3 to = a.position_ned_m + Vector3(offset.x(), offset.y(), -approach.vmd_m);
  track::turn_and_move(
      intruder, course - course_rad(b.velocity_ned_mps), b.position_ned_m, to - b.position_ned_m);
}

double least_distance_m(const Track& own, const Track& intruder) {
  const double begin = std::max(own.times_s.front(), intruder.times_s.front());
  const double end = std::min(own.times_s.back(), intruder.times_s.back());
  if (own.size() < 2 || intruder.size() < 2 || begin > end) return HUGE_VAL;
  std::size_t i = 0, j = 0;
  double least = HUGE_VAL;
  Vector2 from = (on_line(intruder, j, begin) - on_line(own, i, begin)).head<2>();
  for (double time = begin; time < end;) {
    // Each track is straight up to its next sample.
    double next = end;
    for (const auto& [track, at] : {std::pair(&own, i), std::pair(&intruder, j)})
      for (std::size_t k = at + 1; k < track->size(); ++k)
        if (track->times_s[k] > time) {
          next = std::min(next, track->times_s[k]);
          break;
        }
    const Vector2 to = (on_line(intruder, j, next) - on_line(own, i, next)).head<2>();
    least = std::min(least, least_on_segment(from, to));
    from = to;
    time = next;
  }
  return std::min(least, from.norm());
}

namespace {

// False where the tracks come closer at another time.
bool passes_as_drawn(const Track& own, const Track& intruder, const ClosestApproach& approach) {
  return least_distance_m(own, intruder) >= std::abs(approach.hmd_m) - kMaxMissError_m;
}

}  // namespace

double mean_relative_speed_mps(double a_mps, double b_mps, double climb_difference_mps) {
  const double fastest = std::hypot(a_mps + b_mps, climb_difference_mps);
  if (fastest == 0) return 0;
  const double modulus = std::min(1.0, 2 * std::sqrt(a_mps * b_mps) / fastest);
  return 2 * fastest / kPi * std::comp_ellint_2(modulus);
}

std::optional<Pairing> pair(const Track& own,
                            Track& intruder,
                            const PairingOptions& options,
                            Random& random) {
  if (!(options.hmd_m.low() < options.hmd_m.high() && options.vmd_m.low() < options.vmd_m.high()))
    throw Error(
        "a miss distance is a single value; expected a range, over which traffic is uniform");
  const Vector3 a = state_of(own, options.cpa_time_s).velocity_ned_mps;
  const Vector3 b = state_of(intruder, options.cpa_time_s).velocity_ned_mps;
  const double mean_mps =
      mean_relative_speed_mps(a.head<2>().norm(), b.head<2>().norm(), b.z() - a.z());
  for (int i = 0; i < kMaxDraws; ++i) {
    const auto course = drawn_course_rad(a, b, random);
    if (!course) return std::nullopt;
    Pairing pairing;
    pairing.approach = {options.cpa_time_s,
                        degrees(*course),
                        options.hmd_m.quantile(random.uniform()),
                        options.vmd_m.quantile(random.uniform())};
    place(intruder, own, pairing.approach);
    if (!passes_as_drawn(own, intruder, pairing.approach)) continue;
    pairing.weight = mean_mps * density_ratio(options.hmd_m, pairing.approach.hmd_m) *
                     density_ratio(options.vmd_m, pairing.approach.vmd_m);
    return pairing;
  }
  return std::nullopt;
}

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
    : options_(options), seed_(seed), count_(count) {
  if (count < 1) throw Error("0 encounters are asked for; expected 1 or more");
  if (options.speed_mps.low() < 0)
    throw Error(fmt::format("speed_mps begins at {}; expected 0 or more", options.speed_mps.low()));
}

Geometry GeometricSampler::draw(std::uint64_t index, std::uint64_t attempt) const {
  const Strata strata(attempt == 0 ? seed_ : Seed(seed_).stream("geometry drawn again", attempt)(),
                      count_,
                      kDimensions);
  const auto value = [&](const Distribution& distribution, Dimension dimension) {
    return distribution.quantile(strata.at(index, dimension));
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

GeometricPassage geometric_passage(const GeometricSampler& sampler,
                                   std::uint64_t index,
                                   const track::Track& own,
                                   double begin_s,
                                   double end_s) {
  for (int attempt = 0; attempt < kMaxDraws; ++attempt) {
    const Geometry geometry = sampler.draw(index, static_cast<std::uint64_t>(attempt));
    Track track = geometric_track(own, geometry, begin_s, end_s);
    if (passes_as_drawn(own, track, geometry.approach))
      return {geometry, std::move(track), attempt + 1};
  }
  throw Error(
      fmt::format("each of {} draws of encounter {} turns so that it comes nearer than its miss "
                  "distance at another time; expected wider ranges, slower turns, or an own track "
                  "that ends sooner",
                  kMaxDraws,
                  index + 1));
}

}  // namespace airtruth::pairing
