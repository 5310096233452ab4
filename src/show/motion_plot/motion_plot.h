// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camera/motion/motion.h"
#include "show/plot/plot.h"

namespace airtruth::motion_plot {

// The motion of a clip over its frames, as four plots: how far the centre of the picture moved
// (px), how far the picture turned (degrees), the rms of the inliers (px), and their number. If the
// motion is a rotation, the first two are yaw and pitch, and roll, in degrees. Frames that were not
// measured are shaded, cuts in red. width and height are the video's.
//
// The axis of a plot holds 0 and the middle 98 % of the values, so that a single value far off does
// not press the others flat. Values beyond the axis are drawn at its end as triangles, and the
// title says how many they are.
std::vector<plot::Plot> plots_of(const std::vector<motion::FrameMotion>& frames,
                                 int width,
                                 int height);

}  // namespace airtruth::motion_plot
