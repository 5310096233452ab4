// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "detection/scoring/assessment.h"

namespace airtruth::detection {

struct ScoreOptions {
  double centre_px = 10;
  PointOptions point;
  std::optional<double> manoeuvre_s;
  // True: encounters and the probability of detection also get weighted shares, with
  // TruthSequence::weight.
  bool is_weighted = false;
};

// All measures of one detector. `sequences` state their truth and detections; their verdicts are
// made here. Each has as many frames as its truth.
DetectorScore score_detector(std::string name,
                             std::vector<ScoredDetections> sequences,
                             std::span<const TruthSequence> truths,
                             const ScoreOptions& options);

}  // namespace airtruth::detection
