// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "detection/scoring/track_frames.h"

// The identity measures (Ristani et al. 2016, ECCV workshops, "Performance measures and a data set
// for multi-target, multi-camera tracking"), as TrackEval computes them
// (trackeval/metrics/identity.py): true tracks and answers are paired once for the whole sequence,
// so that the fewest boxes are wrong; boxes agree at an overlap of 0.5 or more.
namespace airtruth::detection {

struct Identity {
  std::int64_t true_positives = 0, false_negatives = 0, false_positives = 0;

  double idf1() const;
  double recall() const;
  double precision() const;
};

Identity identity_of(const TrackFrames& frames);
Identity combined(std::span<const Identity> sequences);

}  // namespace airtruth::detection
