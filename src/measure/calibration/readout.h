// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foundation/geometry/transform.h"
#include "measure/calibration/calibration.h"

namespace airtruth::calibration {

// The readout time as a share of the frame interval, downwards positive. A rolling shutter shears
// and stretches what moves faster at the end of a frame than at its beginning: between neighbours
// the picture's shear is readout / height times the change of its speed across, its stretch the
// same of its speed down. `shots`: of each shot its frames' steps, frame k from frame k - 1, in
// pixels; empty where not known, as of the first.
using Steps = std::vector<std::optional<Homography>>;
std::optional<Estimate> readout_share(const std::vector<Steps>& shots,
                                      int width,
                                      int height,
                                      std::string& why);

}  // namespace airtruth::calibration
