// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/optics/step_response.h"
#include "foundation/image/tone_curve.h"

namespace airtruth::optics {

// The mean profile across the sharpest edges of a clip, with the fitted step response.
struct EdgeProfile {
  // Signed distances from the middle of the edge, px. The three vectors have one size.
  std::vector<double> place_px;
  // Measured and fitted height at each place, 0 on the dark side and 1 on the bright side.
  std::vector<double> height;
  std::vector<double> fitted;
  // The distance between 10 % and 90 % of the height of the fitted response, px.
  double spread_px = 0;
  // The number of edges that were fitted. The profile shows only those whose spread is nearest to
  // the spread of the camera.
  int edges = 0;
};

// The profile of the edges whose spread is nearest to the camera's. `response` must be the fit to
// these edges.
EdgeProfile edge_profile(const std::vector<const StepEdge*>& edges,
                         const StepResponse& response,
                         const image::ToneCurve& tone);

}  // namespace airtruth::optics
