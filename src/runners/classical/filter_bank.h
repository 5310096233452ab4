// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <opencv2/core.hpp>

#include "runners/classical/likelihood.h"

namespace airtruth::classical {

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
