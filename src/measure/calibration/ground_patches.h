// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "foundation/image/tone_curve.h"
#include "measure/calibration/extinction.h"
#include "measure/calibration/ground_track.h"

namespace airtruth::calibration {

// Light of level ground in patches of one size, whatever their distance, so that what is far does
// not look more alike than what is near only because a pixel holds more of it: as large as a pixel
// is on the ground at 2 degrees below the horizon, and beyond that a pixel. One view after the
// other.
std::vector<SeenLight> ground_patches(const std::vector<GroundView>& views,
                                      const lens::Lens& lens,
                                      const image::Mask* own_aircraft,
                                      double altitude_m,
                                      const image::ToneCurve& tone);

}  // namespace airtruth::calibration
