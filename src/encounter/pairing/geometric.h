// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "encounter/pairing/pair.h"
#include "encounter/pairing/strata.h"
#include "encounter/track/track.h"

// Encounters from stated distributions of their geometry, stratified so that few of them cover all.
namespace airtruth::pairing {

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
  // Geometry `index`, below `count`; it depends on options, seed, count and index alone.
  Geometry draw(std::uint64_t index) const;

 private:
  GeometricOptions options_;
  Strata strata_;
};

// The track of the intruder from `begin_s` to `end_s`, one sample each second and one at the end.
// It is exact at the samples: straight lines and circles. The own track must have velocities and
// contain the time of the closest approach; otherwise Error.
track::Track geometric_track(const track::Track& own,
                             const Geometry& geometry,
                             double begin_s,
                             double end_s);

}  // namespace airtruth::pairing
