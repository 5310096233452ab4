// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "evaluation/tracker_evaluation/assess.h"

// The evaluation as JSON, for its file and for its page, and its tables.
namespace airtruth::tracker_evaluation {

// Everything except the tracker's sequences.
nlohmann::ordered_json json_of(const ScoredTracker& tracker);
nlohmann::ordered_json json_of(const ScoredSequence& sequence);
nlohmann::ordered_json json_of(const TrackerPair& comparison);

// Writes evaluation.json, trackers.csv, sequences.csv and breakdown.csv into a folder.
void write_tables(const Assessment& assessment, const fs::path& out);

}  // namespace airtruth::tracker_evaluation
