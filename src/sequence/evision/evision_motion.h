// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "foundation/geometry/transform.h"

namespace airtruth::sequence {

// The position of an intruder without the camera's motion, and the position at which it was found.
struct Sighting {
  Pixel still_px;
  Pixel found_px;
};

// Returns the homography of one frame from the sightings in that frame, over all the sequences that
// share a background. It has four parameters: a shift (two), a roll, and a drift s. The drift
// models what the paper's homographies accumulate while the aircraft flies on over the ground that
// they follow, which draws everything above the horizon towards the horizon. With y down from the
// horizon and s the distance flown divided by the height,
//
//   x' = x / (1 - s y),  y' = y / (1 - s y)
//
// The parameters are found by least squares (Gauss-Newton). Roll and s are held near 0 by 0.1 each,
// so that one sighting gives a shift. `principal_point_px` lies on the horizon, because the nominal
// camera is level. Returns the identity without a sighting.
Homography motion_from_sightings(const std::vector<Sighting>& sightings,
                                 const Pixel& principal_point_px,
                                 double focal_px);

}  // namespace airtruth::sequence
