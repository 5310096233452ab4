// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

// Bins of a quantity: each extends from its edge to the next, and the last one has no upper end.
//
// Example: the edges 0, 100 and 200 make the bins 0 to 100, 100 to 200, and 200 and more. The value
// 100 is in the second, and -1 in none.
namespace airtruth::statistics {

// The bins of range for trackers and detectors alike.
inline const std::vector<double> kRangeEdges_m = {
    0, 100, 200, 300, 400, 500, 750, 1000, 1500, 2000, 3000, 5000, 10000};

// The bins of a set's weather (docs/formats/catalogue.md), by key.
inline const std::map<std::string, std::vector<double>> kWeatherEdges = {
    {"visibility_m", {0, 1000, 2000, 5000, 10000, 20000, 50000}},
    {"exposure", {0, 0.25, 0.5, 0.71, 1, 1.41, 2, 4}},
    {"white_balance", {0, 0.5, 0.71, 0.84, 1, 1.19, 1.41, 2}},
    {"blur", {0, 0.5, 0.75, 1, 1.5, 2, 3, 5}},
    {"noise", {0, 0.5, 0.75, 1, 1.5, 2, 3, 5}},
    {"sun_share", {0, 0.25, 0.5, 0.75}}};

// The bin of a value; empty for an unknown one, and for one below the first edge.
inline std::optional<std::size_t> bin_of(const std::optional<double>& value,
                                         std::span<const double> edges) {
  if (!value || !std::isfinite(*value) || *value < edges.front()) return std::nullopt;
  const auto above = std::upper_bound(edges.begin(), edges.end(), *value);
  return static_cast<std::size_t>(above - edges.begin()) - 1;
}

// The upper end of a bin, which it does not hold.
inline double end_of_bin(std::size_t bin, std::span<const double> edges) {
  return bin + 1 < edges.size() ? edges[bin + 1] : std::numeric_limits<double>::infinity();
}

}  // namespace airtruth::statistics
