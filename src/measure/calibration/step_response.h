// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "measure/calibration/calibration.h"

// A camera's answer to a step of light: a Gaussian point spread in linear light, the tone curve,
// an unsharp mask on what is coded, each of whole pixels (step_model.h). Fitted to edges that were
// found.
namespace airtruth::calibration {

// Samples across one straight edge.
struct StepEdge {
  double low = 0, high = 0;                        // coded luma on its two sides, 0 to 1
  std::vector<std::pair<double, double>> samples;  // place px from its middle, height 0..1
};

struct StepResponse {
  Estimate point_spread_px;  // standard deviation
  Estimate sharpening;       // amount of the mask; 0: none that could be told from nothing
  Estimate sharpening_px;    // standard deviation of its Gaussian
  std::vector<double> edge_spreads_px;  // of each edge: the camera's and what the world adds
};

// Every edge has its own two levels, since the tone curve bends each differently, and its own
// spread: the world is softer than a step, here more and there less. So each edge by itself tells a
// spread and, for a radius, an amount (edge_fit.h). The mask is the camera's and on all edges: it
// has the median of their amounts, and the radius that suits them best. The camera's spread is that
// of the sharpest edges, but for luck (a frontier with errors on both sides: Aigner, Lovell and
// Schmidt 1977, with an exponential one after Meeusen and van den Broeck 1977). Needs an edge at
// least.
StepResponse fit_step_response(const std::vector<const StepEdge*>& edges,
                               const image::ToneCurve& tone);

// The answer that `response` gives at `places_px` to a step between two levels, scaled to 0..1.
std::vector<double> step_heights(const StepResponse& response,
                                 double low,
                                 double high,
                                 const std::vector<double>& places_px,
                                 const image::ToneCurve& tone);

// Between the last place below 10 % of that step's height and the first above 90 %.
double edge_spread_px(const StepResponse& response,
                      double low,
                      double high,
                      const image::ToneCurve& tone);

}  // namespace airtruth::calibration
