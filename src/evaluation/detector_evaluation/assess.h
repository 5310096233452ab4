// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "dataset/sequences/condition.h"
#include "evaluation/scores/detector_score.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"

// Detectors' results in files, scored against a data set in files.
namespace airtruth::detector_evaluation {

// True for results of a detector: a folder with detector.json, a COCO results file or a folder with
// one alone, a folder with det.txt files, and MOTChallenge text without tracks. MOTChallenge text
// with tracks is a tracker's unless `is_mot_of_detector`. False for anything else.
bool holds_detections(const fs::path& results, bool is_mot_of_detector = false);

struct AssessOptions {
  // Radius of matching/boxes.h.
  double centre_px = 10;
  scores::PointOptions point;
  // Seconds that a manoeuvre needs before the volume is violated. Needs `volume`.
  std::optional<double> manoeuvre_s;
  // Name of a volume (encounter/separation/violation.h, or the scenes' own).
  std::string volume;
  // Regions in which detections count neither way (ignored_regions.h); empty: ignore.csv of the
  // data set where it is there.
  fs::path ignore;
  // True: contrast to noise is measured, for which the videos are read.
  bool with_film = true;
  // Number of threads; 0 means one per core.
  int jobs = 0;
  // Sequences for which these do not hold are left out of every measure.
  std::vector<sequences::Condition> where;
  Warn warn;
  std::function<void(std::int64_t done, std::int64_t total)>
      progress;  // counts videos that were read
  std::stop_token stop;
};

// Scores results against a data set. The name of a folder or file is the detector's name. Warns of
// sequences without a result, which are left out of that detector's measures. Throws Error for
// results without any sequence of the set, for results that cannot be read (detections.h), and for
// two of one name.
scores::Assessment assess(const fs::path& set,
                          const std::vector<fs::path>& results,
                          const AssessOptions& options);

}  // namespace airtruth::detector_evaluation
