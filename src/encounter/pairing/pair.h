// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "encounter/pairing/strata.h"
#include "encounter/track/track.h"
#include "foundation/base/seed.h"

// Two tracks that know nothing of each other, put together to an encounter: the intruder is turned
// and moved so that it passes the own aircraft at a stated time and distance. The method is that of
// MIT-LL's em-pairing-uncor-importancesampling (Kochenderfer, Espindle, Kuchar and Griffith 2010,
// "Airspace encounter models for estimating collision risk", section on encounter generation).
namespace airtruth::pairing {

// A distribution that is uniform within each of some bins.
//
//   Distribution({-500, -100, 500}, {1, 3}) has a quarter of its values below -100.
//   Distribution({62}) is always 62.
class Distribution {
 public:
  // `edges` are one number or increasing ones; `shares` are one for each bin, in any unit, and
  // empty for shares in proportion to the bins' widths. Throws Error otherwise, or where a number
  // is not finite, a share is negative or all are 0. `name` is the quantity in messages.
  explicit Distribution(std::vector<double> edges,
                        std::vector<double> shares = {},
                        const std::string& name = "the range");

  // The value below which the share u of the distribution lies; u in [0, 1].
  double quantile(double u) const;
  // 0 outside of the bins. A distribution of one value has no density, and the result is infinite.
  double density(double value) const;
  double low() const { return edges_.front(); }
  double high() const { return edges_.back(); }

 private:
  std::vector<double> edges_;
  // Running sums of the shares, the last of them 1; for one value none.
  std::vector<double> sums_;
};

// Where an intruder is at the closest approach.
struct ClosestApproach {
  double time_s = 0;
  // Its course relative to the own one: 180 head-on, 90 from the left, 0 in the same direction.
  double course_deg = 0;
  // Horizontal miss distance: the intruder is hmd_m (VR_e, -VR_n) / |VR| to the north and east of
  // the own aircraft, where VR is its horizontal velocity less the own one. A positive one is to
  // the right where the intruder is head-on.
  double hmd_m = 0;
  // Vertical miss distance: positive where the intruder is above.
  double vmd_m = 0;
};

// The intruder turned and moved so that its horizontal distance is stationary, and |hmd_m|, at the
// time of the closest approach. Both tracks must have velocities and samples before and after that
// time; otherwise Error. Where both fly with the same horizontal velocity, hmd_m is to the right of
// the own course.
void place(track::Track& intruder, const track::Track& own, const ClosestApproach& approach);

// The least horizontal distance of the two tracks while both fly, on straight lines between their
// samples.
double least_distance_m(const track::Track& own, const track::Track& intruder);

// The mean of |v_a - v_b| over all courses of b, in m/s: horizontal speeds a and b, and the
// difference of the climbs. With A^2 = (a + b)^2 + climb^2 it is (2 A / pi) E(k), where E is the
// complete elliptic integral of the second kind and k^2 = 4 a b / A^2.
double mean_relative_speed_mps(double a_mps, double b_mps, double climb_difference_mps);

// An encounter whose tracks come closer than |hmd_m| by more than this, at another time, is drawn
// again: the public tool allows 500 ft.
inline constexpr double kMaxMissError_m = 5;

struct PairingOptions {
  double cpa_time_s = 30;
  // Drawn; neither may be a single value.
  Distribution hmd_m{{-500, 500}, {}, "hmd_m"};
  Distribution vmd_m{{-150, 150}, {}, "vmd_m"};
};

struct Pairing {
  ClosestApproach approach;
  // Mean relative speed over all courses, in m/s; times the density of the distance in a uniform
  // traffic over the density from which it was drawn, for both distances. Traffic is uniform up to
  // the largest |hmd_m| and |vmd_m|, on both sides.
  double weight = 1;
};

// Draws the approach and places the intruder. The course is uniform, accepted with a probability in
// proportion to the relative speed that it makes: fast encounters are frequent in that proportion.
// Empty where no draw of many passes, for example because the intruder circles.
//
// The weights sum to what they should: the mean of weight / mean relative speed is the share
// (high - low) / (2 max(|low|, |high|)) of hmd_m, times that of vmd_m - 1 for symmetric ranges -
// whatever the shares of the bins are; but for encounters that are drawn again.
std::optional<Pairing> pair(const track::Track& own,
                            track::Track& intruder,
                            const PairingOptions& options,
                            Random& random);

// Encounters from stated distributions of their geometry, stratified so that few of them cover all.

// An intruder that flies at constant airspeed, climb and turn rate.
struct Geometry {
  ClosestApproach approach;
  // Horizontal.
  double speed_mps = 0;
  double climb_mps = 0;
  // Positive to the right.
  double turn_rate_dps = 0;
};

struct GeometricOptions {
  Distribution course_deg{{-180, 180}, {}, "course_deg"};
  Distribution speed_mps{{30, 80}, {}, "speed_mps"};
  Distribution hmd_m{{-500, 500}, {}, "hmd_m"};
  Distribution vmd_m{{-150, 150}, {}, "vmd_m"};
  Distribution climb_mps{{0}, {}, "climb_mps"};
  Distribution turn_rate_dps{{0}, {}, "turn_rate_dps"};
  Distribution cpa_time_s{{30}, {}, "cpa_time_s"};
};

// Draws `count` geometries as a Latin hypercube: each distribution is cut into `count` parts of
// equal probability, and each part is drawn from once.
class GeometricSampler {
 public:
  // Throws Error where a speed is negative, or `count` is 0.
  GeometricSampler(const GeometricOptions& options, std::uint64_t seed, std::uint64_t count);
  // Geometry `index`, below `count`; it depends on options, seed, count, index and attempt alone.
  // Each attempt is a hypercube of its own.
  Geometry draw(std::uint64_t index, std::uint64_t attempt = 0) const;

 private:
  GeometricOptions options_;
  std::uint64_t seed_;
  std::uint64_t count_;
};

// The track of the intruder from `begin_s` to `end_s`, one sample each second and one at the end.
// It is exact at the samples: straight lines and circles. The own track must have velocities and
// contain the time of the closest approach; otherwise Error.
track::Track geometric_track(const track::Track& own,
                             const Geometry& geometry,
                             double begin_s,
                             double end_s);

struct GeometricPassage {
  Geometry geometry;
  track::Track track;
  int draws = 1;
};

// Geometry `index` and its track, of the first attempt that does not come closer than |hmd_m| by
// more than kMaxMissError_m at another time: where an aircraft turns, it can. Throws Error where
// none of many attempts passes as drawn.
GeometricPassage geometric_passage(const GeometricSampler& sampler,
                                   std::uint64_t index,
                                   const track::Track& own,
                                   double begin_s,
                                   double end_s);

}  // namespace airtruth::pairing
