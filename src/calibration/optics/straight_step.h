// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "calibration/optics/step_response.h"

// Finds straight steps of luma in one picture and samples the profile across them to a fraction of
// a pixel (the slanted-edge method of ISO 12233). Pixels have integer centres.
namespace airtruth::optics {

// Half the lengths of edges that are sought, px. The profile of a long edge is less affected by
// what happens to lie beside the edge, but not every clip has enough long edges.
inline constexpr int kLongEdgePx = 15, kShortEdgePx = 5;

// A place with a steep gradient of luma.
struct SteepPlace {
  cv::Point at;
  cv::Point2d slope;  // of the 3 x 3 Sobel filter, code values
};

// The places of a picture of 8-bit luma with a steep gradient, the steepest first.
std::vector<SteepPlace> steep_places(const cv::Mat& grey);

// A straight step between two even levels.
struct StraightStep {
  // Its normal points to the bright side.
  EdgeLine line;
  double width_px = 0;   // standard deviation of the derivative of the profile
  double asymmetry = 0;  // rms difference between the two halves of the profile, as heights
  StepEdge step = {};    // with its levels as code values
};

// The step at a place, over the longer of the two lengths over which it is clean and straight;
// empty if it is over neither. `black`, `white`: the luma of the picture's range, code values.
std::optional<StraightStep> straight_step_at(const cv::Mat& grey,
                                             const SteepPlace& place,
                                             double black,
                                             double white);

}  // namespace airtruth::optics
