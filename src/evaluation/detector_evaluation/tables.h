// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "evaluation/scores/detector_score.h"

namespace airtruth::detector_evaluation {

// What detection.json states of one detector (docs/detection-measures.md). A number that is not
// defined is null.
nlohmann::ordered_json json_of_detector(const scores::DetectorScore& detector,
                                        const scores::Assessment& assessment);

// Writes detection.json, detectors.csv, and detection_sequences.csv, detection_encounters.csv,
// detection_breakdown.csv and detection_curves.csv into a folder.
void write_tables(const scores::Assessment& assessment, const std::filesystem::path& out);

}  // namespace airtruth::detector_evaluation
