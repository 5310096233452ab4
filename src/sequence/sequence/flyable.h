// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "world/trajectory/path.h"

namespace airtruth::sequence {

// One limit of an aircraft's class that its path leaves, at the instant when it is farthest beyond.
struct BeyondLimit {
  enum class Quantity { kFast, kSlow, kBank, kClimb, kDescent };
  Quantity quantity = Quantity::kFast;
  double time_s = 0;  // on the path's clock
  double value = 0;   // m/s, or degrees of bank
  double limit = 0;   // of the class (aircraft/fleet/flight_limits.h)
};

// Where the path of an aircraft of the list, from begin_s to end_s, leaves what its class can fly:
// true airspeed in still air, the bank that its turn takes (tan bank = speed x turn rate / g,
// whatever attitude is stated), climb and descent. At most one of each quantity. Empty where the
// class of the aircraft is not known.
std::vector<BeyondLimit> beyond_limits(const std::string& aircraft,
                                       const trajectory::Path& path,
                                       double begin_s,
                                       double end_s);

// The same as one line: "c172/news (light piston) cannot fly its path: at 1.20 s it flies 131.0
// m/s, the fastest of its class 92 m/s; ..."; "" where it can.
std::string words_beyond_limits(const std::string& aircraft,
                                const trajectory::Path& path,
                                double begin_s,
                                double end_s);

}  // namespace airtruth::sequence
