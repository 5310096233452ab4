// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

namespace airtruth {

// The value, or null where there is none: a record of this program has all its keys, and null says
// that a value is undefined or unknown.
template <typename T>
nlohmann::ordered_json or_null(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

// A number to a whole multiple of a unit of 1, 0.1, 0.01, ...: the nearest double to that decimal,
// so that it is the same after it is written and read.
inline double rounded(double value, double unit) {
  const double per_unit = std::round(1 / unit);
  return std::round(value * per_unit) / per_unit;
}
inline nlohmann::ordered_json rounded(const std::optional<double>& value, double unit) {
  return value ? nlohmann::ordered_json(rounded(*value, unit)) : nlohmann::ordered_json();
}

}  // namespace airtruth
