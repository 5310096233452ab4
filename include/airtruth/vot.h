// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/export.h>

// The measures of the VOT challenges, computed as in the public toolkit (vot-toolkit 0.8):
// accuracy, robustness and expected average overlap (EAO). They exist for two protocols: the one
// that restarts a tracker after each failure (VOT2013 to 2019: Kristan et al. 2016, "A novel
// performance evaluation methodology for single-target trackers", section 4), and the one that
// starts it at many frames (Kristan et al. 2020, "The eighth visual object tracking VOT2020
// challenge results", section 3.2).
namespace airtruth::evaluation {

// The kind of a run's entry for one frame; the numbers are those of VOT's result files.
enum class Mark { kUnknown = 0, kBegun = 1, kFailed = 2, kAnswer };

struct VotFrame {
  Mark mark = Mark::kUnknown;
  // The box of an answer; empty, or with a number that is not finite, where the tracker gave none.
  std::optional<Box> box;
};
using Trajectory = std::vector<VotFrame>;

struct VotTruth {
  // Empty where the frame does not show the target.
  std::vector<std::optional<Box>> boxes;
  // Width of the picture; 0: boxes are not clipped.
  int width = 0;
  int height = 0;
};

// Overlap as the toolkit computes it: both boxes are rounded to whole pixels (halves to even) and
// clipped to the picture, and their pixels are counted. Two boxes that both contain no pixel are
// equal: 1.
AIRTRUTH_API double pixel_overlap(const Box& a, const Box& b, int width, int height);

// Overlap of a frame from a start on (restarts: kBegun and the frames that follow), with the
// toolkit's rule for empty regions: an answer where the target is absent, and no answer where it is
// shown, have an overlap of 0; no answer where it is absent has 1.
AIRTRUTH_API double frame_overlap(const VotFrame& frame,
                                  const std::optional<Box>& truth,
                                  int width,
                                  int height);

struct Restart {
  // Mean overlap without the starts, the 9 frames after each, and the failures.
  double accuracy = 0;
  // Mean number of failures of a run.
  double failures = 0;
  // Equal to exp(-30 failures / length).
  double reliability = 0;
  std::optional<double> eao;
  std::vector<double> eao_curve;
};

// Scores the runs of all sequences; each run is as long as its truth. Accuracy and failures are
// weighted by length. EAO is the mean of the curve over [low, high], as far as the curve extends.
// As in the toolkit, accuracy covers all frames except those marked kUnknown (0 or NaN in result
// files): an answer where the target is absent counts with an overlap of 0.
struct RestartRuns {
  VotTruth truth;
  std::vector<Trajectory> runs;
};
AIRTRUTH_API Restart restart_score(std::span<const RestartRuns> sequences,
                                   std::pair<int, int> eao_range);

// A run from an anchor, a frame of the sequence, to the sequence's end or, backward, to its
// beginning.
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
  // Mean overlap before the failures.
  double accuracy = 0;
  // Share of frames before the failures.
  double robustness = 0;
  std::optional<double> eao;
  std::vector<double> eao_curve;
};

// A run fails at the first of 10 consecutive frames with the target whose overlap is at most 0.1.
// Its first frame has an overlap of 0, as in the toolkit. Two properties of the toolkit are kept:
// it divides the overlap sum of a failed run at frame j by j - 1 beyond the run's end and by j
// within it, and it ends the curve at high - 1. EAO is the mean of the curve over [low, high - 1],
// as far as the curve extends; beyond the longest run, where no run is active, the toolkit counts
// zeros.
AIRTRUTH_API MultiStart multistart_score(std::span<const MultiStartRuns> sequences,
                                         std::pair<int, int> eao_range);

// The starting frames of a tracker: one every `step` frames, the first half forward, the second
// half backward (the last frame replaces the next step). Each moves to the next frame with the
// target, towards the middle. Where two meet in one frame, of which the toolkit's files hold one
// start, the first stays. Step > 0.
struct Anchor {
  std::int64_t frame = 0;
  bool is_backward = false;
  bool operator==(const Anchor&) const = default;
};
AIRTRUTH_API std::vector<Anchor> anchors_of(const VotTruth& truth, int step);

// The range of lengths over which EAO is averaged for a data set. It grows from the mode of a
// Gaussian kernel density of the sequences' lengths (Silverman's width, at least 1 frame) by a
// length at a time to the denser side until it holds half of the density, as in VOT's toolkit of
// 2015. Of several modes it need not be the narrowest that does. For no sequence it is empty.
AIRTRUTH_API std::pair<int, int> eao_range(std::span<const std::int64_t> lengths);

// The range clipped to the extent of the curves of runs of at most `longest` frames. The curves end
// at the index longest - 1; that of a multi-start run ends one before the range's end. The result
// is at least two frames wide where there are so many.
AIRTRUTH_API std::pair<int, int> within_curves(std::pair<int, int> range, std::int64_t longest);

}  // namespace airtruth::evaluation
