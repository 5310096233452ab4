// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <compare>
#include <iterator>
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

// Where a bin lies: in an interval of values, or at a name.
struct Place {
  // Inclusive; of bins by name both are unused.
  double from = 0;
  // Exclusive; infinite for the last bin.
  double to = std::numeric_limits<double>::infinity();
  // Of bins by name: "above", "below".
  std::string name = {};
  auto operator<=>(const Place&) const = default;
};

// Empty for a value that is unknown, or below the first edge.
inline std::optional<Place> place_of(const std::optional<double>& value,
                                     std::span<const double> edges) {
  if (!value || !std::isfinite(*value) || *value < edges.front()) return std::nullopt;
  const auto above = std::upper_bound(edges.begin(), edges.end(), *value);
  Place place{*std::prev(above)};
  if (above != edges.end()) place.to = *above;
  return place;
}

}  // namespace airtruth::statistics
