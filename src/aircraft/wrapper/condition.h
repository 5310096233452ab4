// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

// The properties of the simulation that a FlightGear model reads, and their values at cruise.
namespace airtruth::aircraft {

struct Condition {
  enum class Kind {
    kAnd,
    kOr,
    kNot,
    kLess,
    kLessEquals,
    kGreater,
    kGreaterEquals,
    kEquals,
    kNotEquals,
    kTrue
  };
  Kind kind = Kind::kAnd;  // kAnd without parts is true
  std::string property;
  std::optional<std::string> other_property;
  double value = 0;
  bool compares_text = false;  // the value is a word, which equals no property here
  std::vector<Condition> parts;
};

// A number that follows a property: by a table, or factor * value + offset,
// within bounds.
struct Driven {
  std::string property;  // empty: the offset alone
  double factor = 1;
  double offset = 0;
  std::optional<double> least;
  std::optional<double> most;
  std::vector<std::pair<double, double>> table;  // by rising first number
};

// The state at cruise: speed and height from the load options, gear down only near the ground,
// engines running, control surfaces and switches at rest, daylight.
struct Cruise {
  double airspeed_kt = 250;
  double altitude_agl_ft = 3000;
};
double property_value(const std::string& property, const Cruise& cruise);
bool holds(const Condition& condition, const Cruise& cruise);
double value_of(const Driven& driven, const Cruise& cruise);

}  // namespace airtruth::aircraft
