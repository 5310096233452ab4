// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/measured/measured.h"
#include "calibration/optics/step_response.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"

// Measures how much softer chroma is than luma across the same edges. Cameras and codecs keep less
// colour detail than the grid of chroma samples could hold: on the clips of data/camera-profiles,
// edges that luma crosses within 2 px are 6 to 9 px wide in Cb and Cr.
namespace airtruth::optics {

// Of the steps of Cb and Cr across the edge that are clean enough to fit, at most two: the variance
// of the Gaussian that fits the step best, minus the variance that the sampling grids add, in
// squared luma pixels. Empty for a picture without chroma.
std::vector<double> chroma_variances(const image::Picture& picture, const EdgeLine& line);

// An edge with a step of luma and steps of chroma. Both pointers refer to the caller's data.
struct LumaAndChroma {
  const StepEdge* luma = nullptr;
  const std::vector<double>* chroma = nullptr;  // chroma_variances()
};

// The extra spread of chroma beyond luma, a standard deviation in luma pixels: the square root of
// the median difference between the variances of chroma and luma. It uses edges whose luma is
// nearly as sharp as the camera's step response `response`. The error is the scatter of the
// differences divided by the square root of `at_once`, the largest number of such edges in one
// frame: edges of other frames may be the same edges again. Not measured where there are fewer
// than 12 steps.
Measured<Estimate> chroma_spread(const std::vector<LumaAndChroma>& edges,
                                 std::size_t at_once,
                                 const StepResponse& response,
                                 const image::ToneCurve& tone);

}  // namespace airtruth::optics
