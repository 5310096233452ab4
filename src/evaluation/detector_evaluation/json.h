// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "evaluation/detector_scores/detector_score.h"

namespace airtruth::detector_evaluation {

// What detection.json states of one detector (docs/detection-measures.md). A number that is not
// defined is null.
nlohmann::ordered_json json_of_detector(const detector_scores::DetectorScore& detector,
                                        const detector_scores::Assessment& assessment);

}  // namespace airtruth::detector_evaluation
