// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "detection/scoring/assessment.h"

// The measures of detections as parts of detection.json.
namespace airtruth::detection {

// Null without a trial.
nlohmann::ordered_json json_of(const Share& share);
nlohmann::ordered_json json_of(const std::optional<MeanOf>& mean);
nlohmann::ordered_json json_of(const AveragePrecision& ap);
// `has_hours`: false where the duration of the sequences is unknown.
nlohmann::ordered_json json_of(const FrocPoint& point, bool has_hours);
nlohmann::ordered_json json_of(const Froc& froc);
nlohmann::ordered_json json_of(const DetectionBin& bin);
nlohmann::ordered_json json_of(const std::optional<BearingError>& error);
nlohmann::ordered_json json_of(const AotScore& aot, bool has_hours);

}  // namespace airtruth::detection
