// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/log.h"
#include "evaluation/metrics.h"

namespace airtruth::dataset {

namespace fs = std::filesystem;

struct ScoredSequence {
  std::string name;
  evaluation::Score score;
};

struct ScoredTracker {
  std::string name;
  evaluation::Score overall;
  std::vector<ScoredSequence> sequences;
};

// Scores folders of results (dataset/track.h: SEQUENCE.txt, SEQUENCE_time.txt where times are
// known; a folder's name is its tracker's) against a data set. `origin_px`: what the results call
// the first pixel, 0 or
// 1. A line that is not finite or has no area is a frame without an answer. Error at the file for
// results of another length than their sequence; warns of results for sequences that the set has
// not, and of sequences without a result, which are left out of that tracker's score.
std::vector<ScoredTracker> evaluate(const fs::path& set,
                                    const std::vector<fs::path>& results,
                                    int origin_px,
                                    const Warn& warn);

// evaluation.json, trackers.csv and sequences.csv, in a folder.
void write_evaluation(const std::vector<ScoredTracker>& trackers, const fs::path& out);

}  // namespace airtruth::dataset
