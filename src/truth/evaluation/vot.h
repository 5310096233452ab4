// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "foundation/geometry/box.h"

// The measures of the VOT challenges, as the public toolkit (vot-toolkit 0.8) takes them: accuracy,
// robustness and expected average overlap (EAO) for the protocol that starts a tracker anew after
// each failure (VOT2013 to 2019: Kristan et al. 2016, "A novel performance evaluation methodology
// for single-target trackers", section 4) and for the one that starts it at many frames (Kristan et
// al. 2020, "The eighth visual object tracking VOT2020 challenge results", section 3.2).
namespace airtruth::evaluation {

// What a run holds for a frame; the numbers are those of VOT's result files.
enum class Mark { kUnknown = 0, kBegun = 1, kFailed = 2, kAnswer };

struct VotFrame {
  Mark mark = Mark::kUnknown;
  std::optional<Box> box;  // of an answer; empty where the tracker gave none
};
using Trajectory = std::vector<VotFrame>;

struct VotTruth {
  std::vector<std::optional<Box>> boxes;  // empty where the target is not seen
  int width = 0;                          // of the picture; 0: nothing is cut
  int height = 0;
};

// As the toolkit does it: both boxes rounded to whole pixels (halves to even), cut to the picture,
// pixels counted. Two boxes without a pixel between them are equal: 1.
double pixel_overlap(const Box& a, const Box& b, int width, int height);

// Of the frames from a start on (restarts: kBegun and the frames that follow), as the toolkit has
// it for empty regions: an answer where the target is absent, and no answer where it is shown, have
// an overlap of 0; no answer where it is absent has 1.
double frame_overlap(const VotFrame& frame, const std::optional<Box>& truth, int width, int height);

struct Restart {
  double accuracy = 0;     // mean overlap without starts, the 9 frames after each, and failures
  double failures = 0;     // a run
  double reliability = 0;  // exp(-30 failures / length)
  std::optional<double> eao;
  std::vector<double> eao_curve;
};

// Every sequence's runs, each as long as its truth. Accuracy and failures weigh by length; EAO is
// the curve's mean over [low, high], the part of it that there is. Accuracy is, as in the toolkit,
// over all frames but those marked kUnknown (which result files give as 0 or with a NaN): an answer
// where the target is absent counts, with an overlap of 0.
struct RestartRuns {
  VotTruth truth;
  std::vector<Trajectory> runs;
};
Restart restart_score(std::span<const RestartRuns> sequences, std::pair<int, int> eao_range);

// A run from an anchor to the sequence's end or, backward, to its beginning.
struct AnchorRun {
  std::int64_t anchor = 0;
  bool is_backward = false;
  Trajectory frames;
};
struct MultiStartRuns {
  VotTruth truth;
  std::vector<AnchorRun> runs;
};
struct MultiStart {
  double accuracy = 0;    // mean overlap before the failures
  double robustness = 0;  // share of frames before the failures
  std::optional<double> eao;
  std::vector<double> eao_curve;
};

// A run fails at the first of 10 frames with the target, one after another, whose overlap is at
// most 0.1; its first frame has an overlap of 0, as in the toolkit. The toolkit takes the mean
// overlap of a failed run at frame j beyond its end over j - 1 frames, within it over j, and ends
// the curve at high - 1; both are kept. EAO is the curve's mean over [low, high - 1], the part of
// it that there is: beyond the longest run, where no run is active, the toolkit counts zeros.
MultiStart multistart_score(std::span<const MultiStartRuns> sequences,
                            std::pair<int, int> eao_range);

// Where a tracker is begun: every `step` frames, the first half forward, the second backward (the
// last frame in place of the next step), moved to the next frame with the target towards the
// middle. Step > 0.
struct Anchor {
  std::int64_t frame = 0;
  bool is_backward = false;
  bool operator==(const Anchor&) const = default;
};
std::vector<Anchor> anchors_of(const VotTruth& truth, int step);

// The lengths over which EAO is taken for a data set: the narrowest range that holds half of a
// Gaussian kernel density of the sequences' lengths (Silverman's width, at least 1 frame);
// VOT2015's rule. Empty for no sequence.
std::pair<int, int> eao_range(std::span<const std::int64_t> lengths);

// The range cut to what the curves of runs of at most `longest` frames hold: they end at the index
// longest - 1, that of a multi-start run one before the range's end. At least two frames wide where
// there are so many.
std::pair<int, int> within_curves(std::pair<int, int> range, std::int64_t longest);

}  // namespace airtruth::evaluation
