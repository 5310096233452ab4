// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "evaluation/detector_scores/detector_score.h"

// The measures of detectors as parts of detection.json (docs/detection-measures.md). A number that
// is not defined is null.
namespace airtruth::detector_evaluation {

// The measures of detections as parts of detection.json.

// Null without a trial.
nlohmann::ordered_json json_of(const statistics::Proportion& share);
nlohmann::ordered_json json_of(const std::optional<detector_scores::WeightedMean>& mean);
nlohmann::ordered_json json_of(const detection_measures::AveragePrecision& ap);
// `has_hours`: false where the duration of the sequences is unknown.
nlohmann::ordered_json json_of(const detection_measures::FrocPoint& point, bool has_hours);
nlohmann::ordered_json json_of(const detection_measures::Froc& froc);
nlohmann::ordered_json json_of(const detector_scores::DetectionBin& bin);
nlohmann::ordered_json json_of(const std::optional<detection_measures::BearingError>& error);
nlohmann::ordered_json json_of(const detection_measures::AotScore& aot, bool has_hours);

// The measures of a detector's tracks as a part of detection.json.

// Null for results without tracks.
nlohmann::ordered_json tracks_json_of(const detector_scores::DetectorScore& detector,
                                      const detector_scores::Assessment& assessment);

// What detection.json states of one detector (docs/detection-measures.md). A number that is not
// defined is null.
nlohmann::ordered_json json_of(const detector_scores::DetectorScore& detector,
                               const detector_scores::Assessment& assessment);

}  // namespace airtruth::detector_evaluation
