// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "detection/scoring/assessment.h"

namespace airtruth::detection {

// What detection.json states of one detector (docs/detection-measures.md). A number that is not
// defined is null.
nlohmann::ordered_json json_of(const DetectorScore& detector, const Assessment& assessment);

}  // namespace airtruth::detection
