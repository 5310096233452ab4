// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "evaluation/report/film.h"
#include "evaluation/report/run_options.h"
#include "evaluation/scores/detector_score.h"

namespace airtruth::detector_evaluation {

// The pictures of a page. Empty films and cutouts: the sequence's video is not known.
struct Film {
  // As scores::Assessment::truths. The subject of a still is the aircraft that counts and is
  // largest, else the strongest detection of the first detector.
  std::vector<std::vector<report::Still>> sequences;
  // As DetectorScore::false_alarms and misses of each detector.
  std::vector<std::vector<report::Cutout>> false_alarms, misses;
};

// Reads the video of each sequence with results once, as far as its last frame that is shown.
// Stills are spread over a sequence; the frames of its false alarms and misses are among them while
// there is room. Throws Error where a video ends before a frame that it should show.
Film film_of(const scores::Assessment& assessment, const report::RunOptions& run);

}  // namespace airtruth::detector_evaluation
