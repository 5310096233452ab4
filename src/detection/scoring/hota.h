// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "detection/scoring/track_frames.h"

// Higher order tracking accuracy (Luiten et al. 2021, Int. J. Computer Vision 129, 548), as the
// authors' toolkit computes it (TrackEval, trackeval/metrics/hota.py): each frame has one
// assignment, on overlap times the alignment of the two tracks over the whole sequence, and is
// counted at 19 thresholds of overlap.
//
// Example: a track of 4 frames is answered exactly in the first 3 by one track and in the last by
// another. At each threshold TP = 4, DetA = 1, AssA = (3 * 3/4 + 1 * 1/4) / 4 = 0.625, HOTA =
// sqrt(0.625) = 0.7906.
namespace airtruth::detection {

constexpr int kHotaSteps = 19;  // overlaps 0.05, 0.10 .. 0.95

struct Hota {
  using Curve = std::array<double, kHotaSteps>;
  Curve hota{}, det_a{}, ass_a{}, det_re{}, det_pr{}, ass_re{}, ass_pr{}, loc_a{};
  Curve true_positives{}, false_negatives{}, false_positives{};
  // Mean over the thresholds.
  static double mean(const Curve& curve);
};

Hota hota_of(const TrackFrames& frames);
// Over sequences: counts are added, associations weighted by true positives.
Hota combined(std::span<const Hota> sequences);

}  // namespace airtruth::detection
