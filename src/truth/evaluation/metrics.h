// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"

// How well a tracker's boxes agree with the truth. Boxes are continuous; overlap is the area of the
// intersection over that of the union; centres are x + width / 2, y + height / 2 (the public
// toolkits take x + (width - 1) / 2, which differs only where sizes differ).
namespace airtruth::evaluation {

struct FramePair {
  std::optional<Box> truth;   // empty: the target is not seen in the frame
  std::optional<Box> answer;  // empty: the tracker gave none
  double seconds = 0;         // that the answer took
};

// Within [0, 1]; exactly 1 for equal boxes, whatever their coordinates round to.
double overlap(const Box& a, const Box& b);
Pixel centre_of(const Box& box);

// Angle between the rays through the centres of two boxes, milliradians; empty where the lens sees
// nothing at one of them.
std::optional<double> angle_mrad(const lens::Lens& lens, const Box& a, const Box& b);

// Thresholds of the curves: overlaps 0, 0.05 .. 1; distances 0 .. 50 px; normalised distances 0,
// 0.01 .. 0.5.
constexpr int kSuccessSteps = 21;
constexpr int kPrecisionSteps = 51;

struct Score {
  std::int64_t frames = 0;   // of the sequence
  std::int64_t counted = 0;  // with a target

  // The E-Vision paper's, section IV: X and Y of the box's centre against the truth's, pixels, over
  // the frames with a target after the first.
  double x_mean_px = 0, x_rmse_px = 0, x_most_px = 0;
  double y_mean_px = 0, y_rmse_px = 0, y_most_px = 0;
  double centre_mean_px = 0;

  // OTB's one-pass evaluation (Wu, Lim and Yang 2013, section 4): frames without a target are
  // passed over, the first counts as the truth itself. success[k]: share of frames whose overlap is
  // more than 0.05 k; precision[k]: whose centre error is at most k px.
  std::array<double, kSuccessSteps> success{};
  std::array<double, kPrecisionSteps> precision{};
  double auc = 0;             // mean of success
  double precision_20px = 0;  // precision[20]
  // Normalised precision (Mueller et al. 2018, TrackingNet, eq. 2): centre error over the truth's
  // width and height; mean of the curve.
  std::array<double, kPrecisionSteps> normalised{};
  double normalised_auc = 0;

  // GOT-10k (Huang, Zhao and Huang 2019, section 4.1): without the first frame, boxes cut to the
  // picture.
  double average_overlap = 0;
  double success_50 = 0;
  double success_75 = 0;

  // Of 1 / seconds after the first frame, over the frames that have a time above 0; 0: not known.
  double frames_per_second = 0;  // mean, as in OTB and GOT-10k
  double frames_per_second_median = 0;
};

// Frames of one sequence, in order. width, height: of the picture; 0: unknown, nothing is cut. A
// frame with a target and no answer counts as an overlap of 0, an infinite distance in the curves,
// and the last answer's distance in the means.
Score score(std::span<const FramePair> frames, int width, int height);

// Over sequences: plain means of the sequences' numbers (OTB), frames per second over those that
// know them; GOT-10k's over all frames together.
Score mean_of(std::span<const Score> scores);

}  // namespace airtruth::evaluation
