// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "foundation/geometry/transform.h"

namespace airtruth::sequence {

// Where an intruder would be without the camera's motion, and where it was found.
struct Sighting {
  Pixel still_px;
  Pixel found_px;
};

// The homography of one frame from the sightings in it, of all the sequences that share a
// background: a shift, a roll, and what the paper's homographies gather as the aircraft flies on
// over the ground that they follow, which draws all above the horizon towards it. With y down from
// the horizon and s the way flown over the height,
//
//   x' = x / (1 - s y),  y' = y / (1 - s y)
//
// Least squares (Gauss-Newton) of the four with roll and s held near 0 by 0.1 each, so that one
// sighting gives a shift. `principal_point_px` lies on the horizon: the nominal camera is level.
// Identity without a sighting.
Homography motion_from_sightings(const std::vector<Sighting>& sightings,
                                 const Pixel& principal_point_px,
                                 double focal_px);

}  // namespace airtruth::sequence
