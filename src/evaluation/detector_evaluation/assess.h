// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "evaluation/report/run_options.h"
#include "evaluation/scores/detector_score.h"
#include "foundation/base/files.h"

// Detectors' results in files, scored against a data set in files.
namespace airtruth::detector_evaluation {

// True for results of a detector: a folder with detector.json, a COCO results file or a folder with
// one alone, a folder with det.txt files, and MOTChallenge text without tracks. MOTChallenge text
// with tracks is a tracker's unless `is_mot_of_detector`. False for anything else.
bool holds_detections(const fs::path& results, bool is_mot_of_detector = false);

// Whether the score is weighted follows from the set.
struct AssessOptions : report::RunOptions, scores::ScoreOptions {
  // Regions in which detections count neither way (ignored_regions.h); empty: ignore.csv of the
  // data set where it is there.
  fs::path ignore;
};

// Scores results against a data set. The name of a folder or file is the detector's name. Warns of
// sequences without a result, which are left out of that detector's measures. Throws Error for
// results without any sequence of the set, for results that cannot be read (detections.h), and for
// two of one name.
scores::Assessment assess(const fs::path& set,
                          const std::vector<fs::path>& results,
                          const AssessOptions& options);

}  // namespace airtruth::detector_evaluation
