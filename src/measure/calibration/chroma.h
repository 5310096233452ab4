// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foundation/image/picture.h"
#include "measure/calibration/calibration.h"
#include "measure/calibration/step_response.h"

// How much softer chroma is than luma across the same edges. Cameras and codecs keep less of colour
// than the grid of its samples could hold: across edges that luma crosses within 2 px, Cb and Cr
// take 6 to 9 px on the clips of data/camera-profiles.
namespace airtruth::calibration {

// A straight edge in luma, in pixels with integer centres.
struct EdgeLine {
  double x = 0, y = 0;    // on it
  double nx = 0, ny = 0;  // unit vector across it
  double half_length_px = 0;
};

// The step of Cb or of Cr across an edge.
struct ChromaStep {
  double variance_px2 = 0;  // of the Gaussian that fits it best, with all that grids add taken off
  double error_px2 = 0;
};

// Those of Cb and Cr that are clean; none of a picture without chroma.
std::vector<ChromaStep> chroma_steps(const image::Picture& picture, const EdgeLine& line);

// An edge that has both.
struct LumaAndChroma {
  const StepEdge* luma = nullptr;
  const std::vector<ChromaStep>* chroma = nullptr;
};

// Standard deviation in luma pixels of what chroma has beyond luma: the square root of the median
// difference of variances, over edges that luma crosses nearly as fast as the camera can (those of
// `response`). Its error is their scatter over the root of how many there are at once, since edges
// of other frames may be the same again. Empty, with the reason in `why`, where there are too few.
std::optional<Estimate> chroma_spread(const std::vector<LumaAndChroma>& edges,
                                      std::size_t at_once,
                                      const StepResponse& response,
                                      const image::ToneCurve& tone,
                                      std::string& why);

}  // namespace airtruth::calibration
