// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "detection/scoring/assessment.h"

// The measures of a detector's tracks as a part of detection.json.
namespace airtruth::detection {

// Null for results without tracks.
nlohmann::ordered_json tracks_json_of(const DetectorScore& detector, const Assessment& assessment);

}  // namespace airtruth::detection
