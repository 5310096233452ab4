// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/air/extinction.h"
#include "calibration/air/ground_track.h"
#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "foundation/image/tone_curve.h"

namespace airtruth::calibration {

// The light of level ground, averaged over patches of equal size on the ground at any distance.
// Without that, far ground would look more uniform than near ground because a far pixel covers
// more of it. A patch is as large as the ground that one pixel covers at 2 degrees below the
// horizon; farther away a patch is one pixel. The patches of all views follow one another in the
// order of the views.
std::vector<SeenLight> ground_patches(const std::vector<GroundView>& views,
                                      const lens::Lens& lens,
                                      const image::Mask* own_aircraft,
                                      double altitude_m,
                                      const image::ToneCurve& tone);

}  // namespace airtruth::calibration
