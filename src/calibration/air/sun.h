// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/measured/measured.h"
#include "foundation/geometry/transform.h"

// The direction of the sun from the light of the sky.
namespace airtruth::air {

using measured::Measured;
using measured::NotMeasured;

// Light that arrives from one direction above the horizon.
struct SkySample {
  // Unit vector, north-east-down.
  Vector3 direction;
  // Luminance, linear.
  double light = 0;
};

// Direction of the sun, degrees: the azimuth from the world's north, -180 to 180, and the elevation
// above the horizon, 1 to 89.
struct Sun {
  Estimate azimuth_deg, elevation_deg;
};

// The direction towards which the clear sky is brightest. For each direction on a grid a smooth sky
// is fitted: a polynomial in the height, a bright horizon, and lobes about the direction. Clouds
// are brighter than the clear sky behind them, so the fit follows the darker part of the sky
// (asymmetric least squares, Newey and Powell 1987). The direction with the best fit is refined;
// its error is half of the angle to the farthest direction that explains the sky nearly as well.
//
// Not measured with fewer than 2000 samples, where no direction brightens the sky, and where the
// directions that explain the sky nearly as well span more than 45 degrees.
Measured<Sun> sun_of(const std::vector<SkySample>& sky);

}  // namespace airtruth::air
