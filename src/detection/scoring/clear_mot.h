// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "detection/scoring/track_frames.h"

// The CLEAR MOT measures (Bernardin and Stiefelhagen 2008, EURASIP J. Image and Video Processing
// 246309), as TrackEval computes them (trackeval/metrics/clear.py): an answer may match at an
// overlap of 0.5 or more; pairs of the frame before are kept first, then overlap is maximised.
namespace airtruth::detection {

struct ClearMot {
  std::int64_t true_positives = 0, false_negatives = 0, false_positives = 0;
  // An object is answered by another track than when it was last answered, however long ago.
  std::int64_t identity_switches = 0;
  std::int64_t fragmentations = 0;
  // Objects that are answered in more than 80 %, in 20 to 80 %, and in less of their frames.
  std::int64_t mostly_tracked = 0, partly_tracked = 0, mostly_lost = 0;
  std::int64_t frames = 0;
  double overlap_sum = 0;  // of the true positives

  double mota() const;
  double motp() const;
  double recall() const;
  double precision() const;
};

ClearMot clear_mot_of(const TrackFrames& frames);
ClearMot combined(std::span<const ClearMot> sequences);

}  // namespace airtruth::detection
