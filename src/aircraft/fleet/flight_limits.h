// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

// The speeds, climb rates and bank angles of aircraft classes. They bound the paths that are drawn
// for a type, and they reveal a path that the type cannot fly. docs/flight-limits.md has the table
// with its sources. Speeds are true airspeeds in still air.
namespace airtruth::fleet {

struct FlightLimits {
  std::string_view name;  // of the class: "light piston"
  // The envelope of the class: the lowest stall speed and the highest limit speed among its types,
  // so that none of them can fly a path outside it.
  double slowest_mps = 0;
  double fastest_mps = 0;
  double most_bank_deg = 0;
  double most_climb_mps = 0;    // sustained
  double most_descent_mps = 0;  // as a positive number
  // The usual values near other traffic. Paths are drawn from them where a scene states none.
  double usual_low_mps = 0;
  double usual_high_mps = 0;
  double usual_bank_deg = 0;
  double first_hour = 0;  // of the day, local solar time
  double last_hour = 0;
  // Its types, with blanks between: folders of Debian's flightgear-data-ai, and types made in code.
  std::string_view types;
};

const std::vector<FlightLimits>& flight_classes();

// The limits of an aircraft's class by its name in the aircraft list ("c172/news" or "c172");
// nullptr where the type has no class here: model files, balloons, ships, the Space Shuttle.
const FlightLimits* flight_limits(const std::string& aircraft);

}  // namespace airtruth::fleet
