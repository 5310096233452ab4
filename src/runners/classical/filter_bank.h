// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "runners/classical/scale_space.h"

namespace airtruth::classical {

// Measurements for a filter over square cells, and how much more likely a target makes them
// than clutter does.

// Responses are counted in this part of the typical response.
inline constexpr int kPartsOfTypical = 4;
// Cells are sorted by how much noise and clutter is around them, in octaves: a clear sky is not
// judged by what trees do.
inline constexpr int kClutterClasses = 4;

struct Measurement {
  // CV_8U for each cell: the largest relative response of all levels, times kPartsOfTypical.
  cv::Mat response;
  // CV_8U for each cell: its class of clutter.
  cv::Mat clutter;
};
// Of cells of 2 x 2 px.
Measurement measurement_of(const std::vector<Level>& levels, const cv::Size& cells);
// Of cells `factor` times larger: the largest response in each.
Measurement coarser(const Measurement& measurement, int factor, const cv::Size& cells);

// p(response | target) / p(response | clutter), for each class of clutter. The denominator is the
// histogram of all cells of the frames so far (of which targets are few), forgotten over
// kMemoryFrames. The numerator is a normal response about a target's, whose strength is unknown:
// the mean over strengths from kWeakest to kStrongest times the typical response, equally many in
// each octave. With the chance kHidden a target shows nothing.
class LikelihoodRatio {
 public:
  // The strengths are in typical responses, and the chance is that of a frame: choices.
  static constexpr double kMemoryFrames = 30;
  static constexpr double kWeakest = 2.5;
  static constexpr double kStrongest = 60;
  static constexpr double kHidden = 0.1;
  // The odds of ten frames (FilterBank) stay within what a float holds.
  static constexpr double kLargest = 2000;

  LikelihoodRatio();
  void learn(const Measurement& measurement);
  using Table = std::array<float, 256>;
  const Table& of_class(int clutter) const { return ratios_[static_cast<std::size_t>(clutter)]; }

 private:
  std::array<std::array<double, 256>, kClutterClasses> counts_{};
  std::array<Table, kClutterClasses> ratios_{};
  std::array<double, 256> target_{};
};

// A bank of hidden Markov filters over a grid of cells: track before detect (Lai, Ford, Mejias and
// O'Shea 2013, "Vision-based estimation of airborne target pseudobearing rate using hidden Markov
// model filters"; Molloy, Ford and Mejias 2017). Each of four filters has the transitions of one
// quadrant of directions: from a cell to itself and to three neighbours, with equal chance. So a
// target may stay, as on a collision course, or move by up to one cell a frame.
//
// The filters here hold odds and not shares of one whole: for each cell, the odds of a target there
// against none there, so that several targets do not compete,
//
//   odds(m) = ratio(m) (kStays sum_n A(m | n) odds_before(n) + 1 - kStays) ^ kRemembers
//
// where ratio is the likelihood ratio of the measurement. Where there is only clutter, its mean is
// 1, and the mean of the odds is at most 1. The power is exponential forgetting, as in the window
// of the published test statistic: frames are not independent, least of all those of a coded video.
// So ln odds is the log likelihood ratio of a target that moved as the filter says, with the weight
// kRemembers^k for k frames ago, and a constant ratio leads to ln ratio / (1 - kRemembers) at most.
class FilterBank {
 public:
  // The chance that a target is still there a frame later, and the exponent of forgetting: choices.
  static constexpr double kStays = 0.95;
  static constexpr double kRemembers = 0.9;

  explicit FilterBank(const cv::Size& cells);
  // Carries the odds to a grid that was anchored anew (bearing_grid.h).
  void carry(const cv::Mat& former_from_new);
  void update(const cv::Mat& ratio);  // CV_32F for each cell
  // CV_32F for each cell: the mean of the four filters' odds.
  const cv::Mat& odds() const { return mean_; }

 private:
  std::array<cv::Mat, 4> odds_;
  std::array<cv::Mat, 4> before_;
  cv::Mat mean_;
};

}  // namespace airtruth::classical
