// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "calibration/camera_file/calibration.h"
#include "show/plot/plot.h"

namespace airtruth::camera_file {

// What was measured, as four plots: the noise over brightness, the profile of a sharp edge, pitch
// and roll by the horizon over the frames, and a frame with its sky tinted. A plot without data
// says so in its title. The calibration must outlive the plots.
std::vector<plot::Plot> plots_of(const Calibration& calibration);

}  // namespace airtruth::camera_file
