// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "calibration/measured/measured.h"
#include "foundation/geometry/transform.h"

namespace airtruth::sensor {

using measured::Measured;
using measured::NotMeasured;

// The motion of each frame of one shot from the frame before it (frame k from frame k - 1), in
// pixels. An entry is empty if the motion is not known, as for the first frame of a shot.
using Steps = std::vector<std::optional<Homography>>;

// The readout time of a rolling shutter as a share of the frame interval, positive if the sensor is
// read downwards. A rolling shutter shears and stretches the picture when the speed changes between
// frames: between neighbouring frames the shear is readout / height times the change of the
// horizontal speed, and the stretch is readout / height times the change of the vertical speed.
// `shots` has the steps of each shot. Not measured where too few motions are known, where the speed
// changes too little, and where the shear is larger than a readout over a whole frame would cause.
Measured<Estimate> readout_share(const std::vector<Steps>& shots, int width, int height);

}  // namespace airtruth::sensor
