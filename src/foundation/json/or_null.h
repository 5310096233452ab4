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

// A number to a whole multiple of a unit: shorter, and as exact as its reader can use.
inline double rounded(double value, double unit) { return std::round(value / unit) * unit; }
inline nlohmann::ordered_json rounded(const std::optional<double>& value, double unit) {
  return value ? nlohmann::ordered_json(rounded(*value, unit)) : nlohmann::ordered_json();
}

}  // namespace airtruth
