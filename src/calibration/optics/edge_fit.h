// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calibration/optics/step_response.h"
#include "foundation/image/tone_curve.h"

namespace airtruth::optics {

// The samples across one edge, averaged in bins of a quarter of a pixel.
struct GatheredEdge {
  explicit GatheredEdge(const StepEdge& step);
  // Coded luma on the two sides of the edge, 0 to 1.
  double low = 0, high = 0;
  // For each bin: the mean place in px from the middle, the mean height from 0 to 1, and the square
  // root of the number of samples.
  Eigen::VectorXd places, heights, roots;
  // Weight of this edge in the estimate of the unsharp mask.
  double weight = 1;
};

// The parameters that fit one edge by itself.
struct EdgeFit {
  // Standard deviation of the Gaussian spread, px: that of the camera and that of the edge in the
  // world together.
  double spread_px = 1;
  // Standard error of the logarithm of the spread.
  double spread_error = 0;
  // Amount of the unsharp mask and its standard error; the error is 0 if the amount was given.
  double amount = 0, amount_error = 0;
  // Root mean square of the residuals, in heights from 0 to 1.
  double rms = 0;
};

// Fits each edge under an unsharp mask of the given radius (standard deviation, px). The unknowns
// of an edge are its place, its two plateaus, its spread and, if `amount` is empty, the amount of
// the mask. The method is Gauss-Newton, with place and plateaus eliminated by variable projection
// (Golub and Pereyra 1973). The result has one fit per edge, in order. `start`: fits of the same
// edges under another mask, from which the iterations begin; empty if there are none.
std::vector<EdgeFit> fit_edges(const std::vector<GatheredEdge>& edges,
                               double radius_px,
                               std::optional<double> amount,
                               const image::ToneCurve& tone,
                               const std::vector<EdgeFit>& start = {});

}  // namespace airtruth::optics
