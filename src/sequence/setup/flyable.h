// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "foundation/base/log.h"
#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

// What of a scene's paths cannot be flown.
namespace airtruth::setup {

struct World;

// Says in one line which limits of its class (aircraft/fleet/flight_limits.h) an aircraft of the
// list exceeds on its path from begin_s to end_s, each at the instant of the greatest excess:
// "c172/news (light piston) cannot fly its path: at 1.20 s it flies 131.0 m/s, the fastest of its
// class 92 m/s; ...". The quantities are true airspeed in still air; the bank of a coordinated turn
// (tan bank = speed x turn rate / g, whatever attitude is stated); climb; and descent. Returns ""
// where the aircraft can fly its path, and where its class is unknown.
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
