// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "benchmark/experiment/assess.h"

// The evaluation as JSON, for its file and for its page.
namespace airtruth::experiment {

// Everything except the tracker's sequences.
nlohmann::ordered_json json_of(const ScoredTracker& tracker);
nlohmann::ordered_json json_of(const ScoredSequence& sequence);
nlohmann::ordered_json json_of(const TrackerPair& comparison);

}  // namespace airtruth::experiment
