// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "measure/calibration/step_response.h"

namespace airtruth::calibration {

// An edge's samples, those within a quarter of a pixel together.
struct GatheredEdge {
  explicit GatheredEdge(const StepEdge& step);
  double low = 0, high = 0;                // coded luma on its two sides, 0 to 1
  Eigen::VectorXd places, heights, roots;  // px, 0..1, square roots of how many samples each
  double weight = 1;                       // of its word on the mask
};

// What suits one edge by itself.
struct EdgeFit {
  double spread_px = 1;     // the camera's, and what it has in the world
  double spread_error = 0;  // of its logarithm
  double amount = 0, amount_error = 0;
  double rms = 0;  // heights that it differs by from that
};

// Every edge under a mask of that radius: its place, plateaus, spread and, where it is not given,
// the mask's amount (Gauss and Newton; place and plateaus by variable projection, Golub and
// Pereyra 1973).
std::vector<EdgeFit> fit_edges(const std::vector<GatheredEdge>& edges,
                               double radius_px,
                               std::optional<double> amount,
                               const image::ToneCurve& tone);

}  // namespace airtruth::calibration
