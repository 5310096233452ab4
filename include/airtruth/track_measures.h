// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/export.h>

// Measures of whole tracks: HOTA, CLEAR MOT and Identity, each as the public toolkit TrackEval
// computes it.
namespace airtruth::evaluation {

// True and reported tracks of a sequence, as HOTA, CLEAR and Identity take them.

struct TrackBox {
  std::int64_t id = 0;  // once a frame at most
  Box box_px;
};
struct TrackFrame {
  std::vector<TrackBox> truths;
  std::vector<TrackBox> answers;
};
using TrackFrames = std::vector<TrackFrame>;

// Higher order tracking accuracy (Luiten et al. 2021, Int. J. Computer Vision 129, 548), as the
// authors' toolkit computes it (TrackEval, trackeval/metrics/hota.py): each frame has one
// assignment, on overlap times the alignment of the two tracks over the whole sequence, and is
// counted at 19 thresholds of overlap.
//
// Example: a track of 4 frames is answered exactly in the first 3 by one track and in the last by
// another. At each threshold TP = 4, DetA = 1, AssA = (3 * 3/4 + 1 * 1/4) / 4 = 0.625, HOTA =
// sqrt(0.625) = 0.7906.

constexpr int kHotaSteps = 19;  // overlaps 0.05, 0.10 .. 0.95

struct Hota {
  using Curve = std::array<double, kHotaSteps>;
  Curve hota{}, det_a{}, ass_a{}, det_re{}, det_pr{}, ass_re{}, ass_pr{}, loc_a{};
  Curve true_positives{}, false_negatives{}, false_positives{};
  // Mean over the thresholds.
  AIRTRUTH_API static double mean(const Curve& curve);
};

AIRTRUTH_API Hota hota_of(const TrackFrames& frames);
// Over sequences: counts are added, associations weighted by true positives.
AIRTRUTH_API Hota combined(std::span<const Hota> sequences);

// The CLEAR MOT measures (Bernardin and Stiefelhagen 2008, EURASIP J. Image and Video Processing
// 246309), as TrackEval computes them (trackeval/metrics/clear.py): an answer may match at an
// overlap of 0.5 or more; pairs of the frame before are kept first, then overlap is maximised.

struct ClearMot {
  std::int64_t true_positives = 0, false_negatives = 0, false_positives = 0;
  // An object is answered by another track than when it was last answered, however long ago.
  std::int64_t identity_switches = 0;
  std::int64_t fragmentations = 0;
  // Objects that are answered in more than 80 %, in 20 to 80 %, and in less of their frames.
  std::int64_t mostly_tracked = 0, partly_tracked = 0, mostly_lost = 0;
  std::int64_t frames = 0;
  double overlap_sum = 0;  // of the true positives

  AIRTRUTH_API double mota() const;
  AIRTRUTH_API double motp() const;
  AIRTRUTH_API double recall() const;
  AIRTRUTH_API double precision() const;
};

AIRTRUTH_API ClearMot clear_mot_of(const TrackFrames& frames);
AIRTRUTH_API ClearMot combined(std::span<const ClearMot> sequences);

// The identity measures (Ristani et al. 2016, ECCV workshops, "Performance measures and a data set
// for multi-target, multi-camera tracking"), as TrackEval computes them
// (trackeval/metrics/identity.py): true tracks and answers are paired once for the whole sequence,
// so that the fewest boxes are wrong; boxes agree at an overlap of 0.5 or more.

struct Identity {
  std::int64_t true_positives = 0, false_negatives = 0, false_positives = 0;

  AIRTRUTH_API double idf1() const;
  AIRTRUTH_API double recall() const;
  AIRTRUTH_API double precision() const;
};

AIRTRUTH_API Identity identity_of(const TrackFrames& frames);
AIRTRUTH_API Identity combined(std::span<const Identity> sequences);

}  // namespace airtruth::evaluation
