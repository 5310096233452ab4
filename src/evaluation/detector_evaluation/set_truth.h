// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "dataset/labelled/labelled_set.h"
#include "evaluation/scores/truth.h"
#include "foundation/base/files.h"
#include "runners/results/results_folder.h"

// The truth of a data set as the measures of detections take it.
namespace airtruth::detector_evaluation {

struct SetTruth {
  std::vector<scores::TruthSequence> sequences;  // sorted by name
  // What detections of these sequences have to fit, in the same order.
  std::vector<results::ExpectedSequence> expected;
  bool is_weighted = false;  // a sequence states a weight
  // What the truth lacks, as sentences for people.
  std::vector<std::string> left_out;
};

// `volume` is the name of a volume whose violation counts; empty: none. `ignore` is the file of
// ignored regions; empty: ignore.csv in the set's folder where it is there.
// An aircraft that is visible without a covered box is in the truth with its visible box and does
// not count. Throws Error for a volume that is neither known nor any sequence's own, for a broken
// file of regions, and for a region that fits no sequence.
SetTruth set_truth(const fs::path& set, const std::string& volume, fs::path ignore);

// Measures the contrast to noise of every aircraft in the sequence's video; without a video nothing
// happens. Throws Error where the video ends before the truth does.
void measure_contrast(scores::TruthSequence& truth, const std::stop_token& stop);

}  // namespace airtruth::detector_evaluation
