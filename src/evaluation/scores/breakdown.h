// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "evaluation/scores/truth.h"
#include "evaluation/statistics/bins.h"
#include "evaluation/statistics/proportion.h"

// Probability of detection by a quantity: of the aircraft in frames, the share that is found. With
// the weights of sequences that were drawn from an encounter model it is also the share of the
// aircraft in frames that the model has (statistics/proportion.h).
namespace airtruth::scores {

// One aircraft in one frame.
struct AircraftInFrame {
  // Index in DetectorScore::sequences.
  std::size_t sequence = 0;
  std::size_t frame = 0;   // index in TruthSequence::frames
  std::size_t object = 0;  // index in TruthFrame::objects
  // A detection of the operating point's score or more finds it.
  bool is_detected = false;
};

using statistics::Place;
using statistics::place_of;

struct DetectionBin {
  Place place;
  statistics::Proportion detection;
  // With the sequences' weights; empty where they have none.
  std::optional<statistics::Proportion> weighted;
};

// places[i] belongs to sightings[i]; one without a place is in no bin. Bins are in the order of
// their places; those without a sighting are left out. `weights`: of the sequences; empty: they
// have none.
std::vector<DetectionBin> detection_by(std::span<const AircraftInFrame> sightings,
                                       std::span<const std::optional<Place>> places,
                                       std::span<const double> weights);

// The quantities, as keys of DetectorScore::by: "range_m", "size_px" (longer side), "area_px"
// (pixels on target), "contrast_to_noise", "azimuth_deg", "to_closest_approach_s", "horizon"
// ("above", "below"), "background" (file names), and the keys of statistics::kWeatherEdges.
struct Quantity {
  std::string key;
  std::string title;  // for plots: "range, m"
  std::function<std::optional<Place>(const TruthSequence&, const TruthObject&)> place_of;
};
const std::vector<Quantity>& quantities();

}  // namespace airtruth::scores
