// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "foundation/base/log.h"
#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

// What of a scene's paths cannot be flown.
namespace airtruth::setup {

struct World;

// A limit of an aircraft's class that its path exceeds, at the instant of the greatest excess.
struct BeyondLimit {
  enum class Quantity { kFast, kSlow, kBank, kClimb, kDescent };
  Quantity quantity = Quantity::kFast;
  double time_s = 0;  // on the path's clock
  double value = 0;   // m/s, or degrees of bank
  double limit = 0;   // of the class (aircraft/fleet/flight_limits.h)
};

// Returns the limits of its class that an aircraft of the list exceeds on its path from begin_s to
// end_s. The quantities are true airspeed in still air; the bank of a coordinated turn (tan bank =
// speed x turn rate / g, whatever attitude is stated); climb; and descent. Each quantity occurs at
// most once. Returns an empty list where the aircraft's class is unknown.
std::vector<BeyondLimit> beyond_limits(const std::string& aircraft,
                                       const trajectory::Path& path,
                                       double begin_s,
                                       double end_s);

// Describes the same in one line: "c172/news (light piston) cannot fly its path: at 1.20 s it flies
// 131.0 m/s, the fastest of its class 92 m/s; ...". Returns "" where the aircraft can fly its path.
std::string words_beyond_limits(const std::string& aircraft,
                                const trajectory::Path& path,
                                double begin_s,
                                double end_s);

// Warns, at the place of the intruder, where its aircraft cannot fly its path from 0 to end_s.
void warn_not_flyable(const scene::Intruder& intruder,
                      const trajectory::Path& path,
                      double end_s,
                      const Warn& to_warn);

// Warns, at the place of each table of the scene, where the paths of its intruders go below the
// ground from 0 to end_s: a flock is one table. A scene knows of the ground that it is at down = 0,
// the height from which its own is counted, as long as the camera flies above that; where the
// camera does not, nothing is known and nothing is said.
void warn_below_ground(const scene::Scene& scene,
                       const World& world,
                       double end_s,
                       const Warn& to_warn);

}  // namespace airtruth::setup
