// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

// Measures how the camera reproduces the outline of a silhouette, from profiles across the outline.
namespace airtruth::appearance {

struct Outline {
  double edge_width_px = 0;  // 10 to 90 % of the step, median along the outline; 0: no clear edge
  // Overshoot of the sky beside the outline relative to the sky further off, away from the
  // aircraft, as a share of the step.
  double halo = 0;
};

// `level`: the surroundings (surroundings_of()). All of one size; `grey` and `level` float.
Outline outline_of(const cv::Mat& grey, const cv::Mat& silhouette, const cv::Mat& level);

}  // namespace airtruth::appearance
