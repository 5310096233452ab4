// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

// What a FlightGear model asks of the simulation that it hangs in, and the
// answers for cruise.
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
  bool compares_text = false;  // the value is a word: no property of ours equals it
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

// Speed and height from the load options, gear down near the ground alone,
// engines running, surfaces and switches at rest, daylight.
struct Cruise {
  double airspeed_kt = 250;
  double altitude_agl_ft = 3000;
};
double property_value(const std::string& property, const Cruise& cruise);
bool holds(const Condition& condition, const Cruise& cruise);
double value_of(const Driven& driven, const Cruise& cruise);

}  // namespace airtruth::aircraft
