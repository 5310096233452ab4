// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/breakdown.h"

#include <map>

namespace airtruth::scores {
namespace {

using Value = std::optional<double>;
using Object = const TruthObject&;
using PlaceOf = decltype(Quantity::place_of);

PlaceOf by_value(const std::vector<double>& edges, Value (*value_of)(Object)) {
  return [edges, value_of](const TruthSequence&, Object object) {
    return place_of(value_of(object), edges);
  };
}

PlaceOf by_weather(const std::string& key, const std::vector<double>& edges) {
  return [key, edges](const TruthSequence& sequence, Object) {
    const auto fact = sequence.weather.find(key);
    return place_of(fact == sequence.weather.end() ? Value() : Value(fact->second), edges);
  };
}

std::optional<Place> named(const std::string& name) {
  return name.empty() ? std::nullopt : std::optional(Place{.name = name});
}

std::vector<Quantity> with_weather(std::vector<Quantity> quantities) {
  for (const auto& [key, edges] : statistics::kWeatherEdges)
    quantities.push_back({key, key, by_weather(key, edges)});
  return quantities;
}

}  // namespace

std::vector<DetectionBin> detection_by(std::span<const AircraftInFrame> sightings,
                                       std::span<const std::optional<Place>> places,
                                       std::span<const double> weights) {
  std::map<Place, statistics::TrialsBySequence> trials;
  for (std::size_t i = 0; i < sightings.size(); ++i)
    if (places[i]) trials[*places[i]].add(sightings[i].sequence, sightings[i].is_detected);
  std::vector<DetectionBin> bins;
  for (const auto& [place, of_bin] : trials) {
    DetectionBin& bin = bins.emplace_back();
    bin.place = place;
    bin.detection = of_bin.proportion();
    if (weights.empty()) continue;
    bin.weighted = of_bin.proportion(weights);
    // A bin whose encounters the model never has: no proportion of it is known.
    if (!(bin.weighted->trials > 0)) bin.weighted.reset();
  }
  return bins;
}

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = with_weather(
      {{"range_m",
        "range, m",
        by_value(statistics::kRangeEdges_m, [](Object object) { return object.range_m; })},
       {"size_px",
        "longer side, px",
        by_value({0, 3, 5, 7, 10, 15, 20, 30, 40, 60, 80, 120, 200, 400},
                 [](Object object) { return Value(object.size_px()); })},
       {"area_px",
        "pixels on target",
        by_value({0, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000},
                 [](Object object) { return Value(object.area_px); })},
       {"contrast_to_noise",
        "contrast to noise",
        by_value({0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64},
                 [](Object object) { return object.contrast_to_noise; })},
       {"azimuth_deg",
        "azimuth, deg",
        by_value({-180, -90, -70, -50, -40, -30, -20, -10, 0, 10, 20, 30, 40, 50, 70, 90},
                 [](Object object) { return object.azimuth_deg; })},
       {"to_closest_approach_s",
        "time to closest approach, s",
        by_value({-600, -60, -30, -10, 0, 2, 5, 10, 15, 20, 30, 45, 60, 90, 120, 300},
                 [](Object object) { return object.to_closest_approach_s; })},
       {"horizon",
        "against the horizon",
        [](const TruthSequence&, Object object) {
          return named(!object.above_horizon ? "" : *object.above_horizon ? "above" : "below");
        }},
       {"background", "background", [](const TruthSequence& sequence, Object) {
          return named(sequence.background);
        }}});
  return all;
}

}  // namespace airtruth::scores
