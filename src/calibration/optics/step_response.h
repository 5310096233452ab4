// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "calibration/measured/measured.h"
#include "foundation/image/tone_curve.h"

// The step response of a camera: a Gaussian point spread in linear light, the tone curve and an
// unsharp mask on coded luma, each integrated over whole pixels (StepModel, edge_fit.h). It is
// fitted to the edges of a clip.
namespace airtruth::optics {

using measured::Measured;
using measured::NotMeasured;

// A straight edge in luma, in pixels with integer centres.
struct EdgeLine {
  double x = 0, y = 0;    // a point on the edge
  double nx = 0, ny = 0;  // unit vector across the edge
  double half_length_px = 0;
};

// Samples across one straight edge.
struct StepEdge {
  // Coded luma on the two sides, 0 to 1.
  double low = 0, high = 0;
  // Pairs of the place, in px from the middle, and the height, 0 to 1.
  std::vector<std::pair<double, double>> samples;
};

struct StepResponse {
  // Standard deviation of the point spread; along the rows where it differs along the columns.
  Estimate point_spread_px;
  // Amount of the unsharp mask; 0 if it does not differ significantly from 0.
  Estimate sharpening;
  // Standard deviation of the Gaussian of the unsharp mask.
  Estimate sharpening_px;
  // The spread of each edge: that of the camera and that of the edge in the world together.
  std::vector<double> edge_spreads_px;
  // What the point spread along the columns has beyond that along the rows, a standard deviation.
  Measured<Estimate> vertical_spread_px = NotMeasured{"edges of all directions are taken together"};
};

// Fits the step response to one edge or more. Each edge has its own two levels, since the tone
// curve bends each step differently, and its own spread, since edges in the world are softer than a
// step by different amounts. Each edge alone therefore gives a spread and, for a given radius, an
// amount of sharpening (edge_fit.h). The unsharp mask belongs to the camera and is the same on all
// edges: its amount is the median of theirs, and its radius is the one that fits all edges best.
// The spread of the camera is the lower bound of the edges' spreads, apart from random errors. It
// is estimated as a stochastic frontier: an exponential excess (Meeusen and van den Broeck 1977)
// plus a symmetric error (Aigner, Lovell and Schmidt 1977).
StepResponse fit_step_response(const std::vector<const StepEdge*>& edges,
                               const image::ToneCurve& tone);

// The spread of the camera alone, by edges under a mask that is known.
Estimate camera_spread_px(const std::vector<const StepEdge*>& edges,
                          const StepResponse& mask,
                          const image::ToneCurve& tone);

// The distance in px between the last place below 10 % of the height that `response` gives to
// a step between two levels of coded luma, and the first place above 90 %.
double edge_spread_px(const StepResponse& response,
                      double low,
                      double high,
                      const image::ToneCurve& tone);

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
