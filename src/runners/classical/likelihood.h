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
  static constexpr double kMemoryFrames = 30;
  static constexpr double kWeakest = 2.5;
  static constexpr double kStrongest = 60;
  static constexpr double kHidden = 0.1;
  // The odds of ten frames (filter_bank.h) stay within what a float holds.
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

}  // namespace airtruth::classical
