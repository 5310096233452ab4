// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_scores/breakdown.h"

#include <algorithm>

namespace airtruth::detector_scores {
namespace {

// Trials and finds of each sequence in one bin.
class Trials {
 public:
  explicit Trials(const SightedSequences& sequences)
      : clusters_(sequences.count), weights_(sequences.weights) {}
  void add(const AircraftInFrame& sighting) {
    clusters_[sighting.sequence].trials += 1;
    clusters_[sighting.sequence].successes += sighting.is_detected ? 1 : 0;
  }
  DetectionShares shares() const {
    DetectionShares shares{statistics::proportion_of(clusters_), {}};
    if (weights_.empty()) return shares;
    std::vector<statistics::Cluster> weighted = clusters_;
    for (std::size_t i = 0; i < weighted.size(); ++i) weighted[i].weight = weights_[i];
    shares.weighted = statistics::proportion_of(weighted);
    return shares;
  }

 private:
  std::vector<statistics::Cluster> clusters_;
  std::span<const double> weights_;
};

void set_shares(DetectionBin& bin, const DetectionShares& shares) {
  bin.detection = shares.plain;
  // A bin whose encounters the model never has: no share of it is known.
  if (shares.weighted && shares.weighted->trials > 0) bin.weighted = shares.weighted;
}

}  // namespace

DetectionShares detection_of(std::span<const AircraftInFrame> sightings,
                             const SightedSequences& sequences) {
  Trials trials(sequences);
  for (const AircraftInFrame& sighting : sightings) trials.add(sighting);
  return trials.shares();
}

std::vector<DetectionBin> detection_by(std::span<const AircraftInFrame> sightings,
                                       std::span<const std::optional<double>> values,
                                       std::span<const double> edges,
                                       const SightedSequences& sequences) {
  std::map<std::size_t, Trials> bins;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (!values[i]) continue;
    const auto above = std::upper_bound(edges.begin(), edges.end(), *values[i]);
    if (above == edges.begin()) continue;
    const auto bin = static_cast<std::size_t>(above - edges.begin()) - 1;
    bins.try_emplace(bin, sequences).first->second.add(sightings[i]);
  }
  std::vector<DetectionBin> result;
  for (const auto& [bin, trials] : bins) {
    DetectionBin& one = result.emplace_back();
    one.from = edges[bin];
    if (bin + 1 < edges.size()) one.to = edges[bin + 1];
    set_shares(one, trials.shares());
  }
  return result;
}

std::vector<DetectionBin> detection_by_name(std::span<const AircraftInFrame> sightings,
                                            std::span<const std::optional<std::string>> names,
                                            const SightedSequences& sequences) {
  std::map<std::string, Trials> bins;
  for (std::size_t i = 0; i < sightings.size(); ++i)
    if (names[i]) bins.try_emplace(*names[i], sequences).first->second.add(sightings[i]);
  std::vector<DetectionBin> result;
  for (const auto& [name, trials] : bins) {
    DetectionBin& one = result.emplace_back();
    one.name = name;
    set_shares(one, trials.shares());
  }
  return result;
}

const std::vector<Quantity>& quantities() {
  using Value = std::optional<double>;
  using Name = std::optional<std::string>;
  using Object = const TruthObject&;
  static const std::vector<Quantity> all = {
      {"range_m",
       "range, m",
       {0, 100, 200, 300, 400, 500, 750, 1000, 1500, 2000, 3000, 5000, 10000},
       [](Object object) { return object.range_m; }},
      {"size_px",
       "longer side, px",
       {0, 3, 5, 7, 10, 15, 20, 30, 40, 60, 80, 120, 200, 400},
       [](Object object) { return Value(object.size_px()); }},
      {"area_px",
       "pixels on target",
       {0, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000},
       [](Object object) { return Value(object.area_px()); }},
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
       }}};
  return all;
}

}  // namespace airtruth::detector_scores
