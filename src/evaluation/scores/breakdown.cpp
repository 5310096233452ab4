// SPDX-License-Identifier: Apache-2.0
#include "evaluation/scores/breakdown.h"

#include <map>

#include "evaluation/statistics/bins.h"

namespace airtruth::scores {
namespace {

// The bins of the sightings that have a key, in the order of the keys. set_key states what a bin
// is.
template <typename Key>
std::vector<DetectionBin> binned(std::span<const AircraftInFrame> sightings,
                                 std::span<const double> weights,
                                 const auto& key_of,
                                 const auto& set_key) {
  std::map<Key, statistics::TrialsBySequence> trials;
  for (std::size_t i = 0; i < sightings.size(); ++i)
    if (const std::optional<Key> key = key_of(i))
      trials[*key].add(sightings[i].sequence, sightings[i].is_detected);
  std::vector<DetectionBin> bins;
  for (const auto& [key, of_bin] : trials) {
    DetectionBin& bin = bins.emplace_back();
    set_key(bin, key);
    bin.detection = of_bin.proportion();
    if (weights.empty()) continue;
    bin.weighted = of_bin.proportion(weights);
    // A bin whose encounters the model never has: no proportion of it is known.
    if (!(bin.weighted->trials > 0)) bin.weighted.reset();
  }
  return bins;
}

std::vector<Quantity> with_weather(std::vector<Quantity> quantities) {
  for (const auto& [key, edges] : statistics::kWeatherEdges)
    quantities.push_back({key, key, edges});
  return quantities;
}

}  // namespace

std::vector<DetectionBin> detection_by(std::span<const AircraftInFrame> sightings,
                                       std::span<const std::optional<double>> values,
                                       std::span<const double> edges,
                                       std::span<const double> weights) {
  return binned<std::size_t>(
      sightings,
      weights,
      [&](std::size_t i) { return statistics::bin_of(values[i], edges); },
      [&](DetectionBin& bin, std::size_t k) {
        bin.from = edges[k];
        bin.to = statistics::end_of_bin(k, edges);
      });
}

std::vector<DetectionBin> detection_by_name(std::span<const AircraftInFrame> sightings,
                                            std::span<const std::optional<std::string>> names,
                                            std::span<const double> weights) {
  return binned<std::string>(
      sightings,
      weights,
      [&](std::size_t i) { return names[i]; },
      [](DetectionBin& bin, const std::string& name) { bin.name = name; });
}

const std::vector<Quantity>& quantities() {
  using Value = std::optional<double>;
  using Name = std::optional<std::string>;
  using Object = const TruthObject&;
  static const std::vector<Quantity> all = with_weather(
      {{"range_m",
        "range, m",
        statistics::kRangeEdges_m,
        [](Object object) { return object.range_m; }},
       {"size_px",
        "longer side, px",
        {0, 3, 5, 7, 10, 15, 20, 30, 40, 60, 80, 120, 200, 400},
        [](Object object) { return Value(object.size_px()); }},
       {"area_px",
        "pixels on target",
        {0, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000},
        [](Object object) { return Value(object.area_px); }},
       {"contrast_to_noise",
        "contrast to noise",
        {0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64},
        [](Object object) { return object.contrast_to_noise; }},
       {"azimuth_deg",
        "azimuth, deg",
        {-180, -90, -70, -50, -40, -30, -20, -10, 0, 10, 20, 30, 40, 50, 70, 90},
        [](Object object) { return object.azimuth_deg; }},
       {"to_closest_approach_s",
        "time to closest approach, s",
        {-600, -60, -30, -10, 0, 2, 5, 10, 15, 20, 30, 45, 60, 90, 120, 300},
        [](Object object) { return object.to_closest_approach_s; }},
       {"horizon",
        "against the horizon",
        {},
        nullptr,
        [](const TruthSequence&, Object object) {
          return object.above_horizon ? Name(*object.above_horizon ? "above" : "below") : Name();
        }},
       {"background", "background", {}, nullptr, [](const TruthSequence& sequence, Object) {
          return sequence.background.empty() ? Name() : Name(sequence.background);
        }}});
  return all;
}

std::optional<double> value_of(const Quantity& quantity,
                               const TruthSequence& sequence,
                               const TruthObject& object) {
  if (quantity.value_of != nullptr) return quantity.value_of(object);
  const auto fact = sequence.weather.find(quantity.key);
  return fact == sequence.weather.end() ? std::nullopt : std::optional(fact->second);
}

}  // namespace airtruth::scores
