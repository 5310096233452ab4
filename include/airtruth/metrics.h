// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <airtruth/box.h>
#include <airtruth/export.h>

// Agreement of a tracker's boxes with the truth. Boxes are continuous. The overlap is the area of
// the intersection over that of the union. The centre is x + width / 2, y + height / 2; the public
// toolkits take x + (width - 1) / 2, which makes a difference only where sizes differ.
//
// Example: the truth (x, y, width, height) = (100, 100, 20, 10) and the answer (105, 100, 20, 10)
// have an intersection of 150 and a union of 250 square pixels, so their overlap is 0.6. The
// centres are 5 px apart; over the truth's width the normalised distance is 0.25. The frame counts
// for success_50 but not for success_75.
namespace airtruth::evaluation {

// The truth and the tracker's answer in one frame.
struct FramePair {
  // Empty, or with a number that is not finite: the frame does not show the target.
  std::optional<Box> truth;
  // Empty, or with a number that is not finite: the tracker gave no box.
  std::optional<Box> answer;
  // Time that the tracker took for the answer, in seconds.
  double seconds = 0;
};

// Intersection over union, within [0, 1]; exactly 1 for equal boxes, whatever the rounding of their
// coordinates, and 0 where a number is not finite.
AIRTRUTH_API double overlap(const Box& a, const Box& b);

// Numbers of thresholds of the curves: overlaps 0, 0.05 .. 1 (kSuccessSteps); distances 0 .. 50 px
// and normalised distances 0, 0.01 .. 0.5 (kPrecisionSteps).
constexpr int kSuccessSteps = 21;
constexpr int kPrecisionSteps = 51;

// The measures of one sequence, or means over sequences. A measure is empty where no frame, or no
// sequence, defines it.
struct Score {
  // Number of frames of the sequence.
  std::int64_t frames = 0;
  // Number of frames that show the target.
  std::int64_t counted = 0;

  // The measures of the E-Vision paper, section IV: errors of X and Y of the box's centre, in
  // pixels, over the frames after the first that show the target and have an answer.
  std::optional<double> x_mean_px, x_rmse_px, x_most_px;
  std::optional<double> y_mean_px, y_rmse_px, y_most_px;
  std::optional<double> centre_mean_px;

  // OTB's one-pass evaluation (Wu, Lim and Yang 2013, section 4). Frames without a target are
  // skipped, and the first frame's answer is the truth itself. success[k]: share of frames whose
  // overlap exceeds 0.05 k. precision[k]: share of frames whose centre error is at most k px. Both
  // curves are 0 where `counted` is.
  std::array<double, kSuccessSteps> success{};
  std::array<double, kPrecisionSteps> precision{};
  // Mean of success.
  std::optional<double> auc;
  // Equal to precision[20].
  std::optional<double> precision_20px;
  // Normalised precision (Mueller et al. 2018, TrackingNet, eq. 2): the centre error divided by the
  // truth's width and height. normalised_auc is the mean of the curve.
  std::array<double, kPrecisionSteps> normalised{};
  std::optional<double> normalised_auc;

  // GOT-10k's measures (Huang, Zhao and Huang 2019, section 4.1): without the first frame, and with
  // boxes bounded to the picture as its toolkit does it.
  std::optional<double> average_overlap;
  std::optional<double> success_50;
  std::optional<double> success_75;

  // Frames a second: 1 / seconds after the first frame, over the frames with a time above 0.
  // Mean, as in OTB and GOT-10k.
  std::optional<double> frames_per_second;
  std::optional<double> frames_per_second_median;

  // Number of frames after the first that show the target: those of GOT-10k's measures.
  std::int64_t counted_after_first = 0;
};

// Scores the frames of one sequence, in order. width and height are those of the picture; 0:
// unknown, and no box is clipped. A frame with a target and no answer counts as an overlap of 0 and
// as an infinite distance in the curves; it has no centre error.
AIRTRUTH_API Score score(std::span<const FramePair> frames, int width, int height);

// Means over the sequences that have the measure: plain means of their numbers (OTB), and GOT-10k's
// measures over the frames of all sequences together.
AIRTRUTH_API Score mean_of(std::span<const Score> scores);

// A target is lost after kGrace frames with an overlap of at most kLostOverlap.
constexpr int kGrace = 10;
constexpr double kLostOverlap = 0.1;

// The frame at which a tracker has lost its target: the first of 10 consecutive frames with the
// target whose overlap is at most 0.1 (Kristan et al. 2020, "The eighth visual object tracking
// VOT2020 challenge results", section 3.2). Fewer frames suffice where the sequence ends within
// them. Empty where the target is never lost.
AIRTRUTH_API std::optional<std::size_t> first_loss(std::span<const FramePair> frames);

}  // namespace airtruth::evaluation
