// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibration/air/air.h"
#include "calibration/camera_file/quantities.h"

namespace airtruth::calibration {

// The extinction of a clip. One that is measured is stated as it is. One that is not measured is
// not applied: air that may be clear is rendered clear. Its value is then 0, with the extinction of
// exceptionally clear air as the error; or, where the horizon looks hazy, a prior from the
// visibility that its look supports, with an error of the same size. A note says so.
// `height_known`: the height above the ground was given and not assumed.
Quantity extinction_quantity(const Air& air, bool height_known);

}  // namespace airtruth::calibration
