// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camera/motion/motion.h"
#include "foundation/image/picture.h"

namespace airtruth::motion {

// How the image's centre moved (x and y, pixels), how far the image turned (degrees), and how well
// it was measured (rms and inliers), over the frames; bridged frames and cuts are shaded. width and
// height are the video's.
image::Rgb8 plot(const std::vector<FrameMotion>& motion, int width, int height);

}  // namespace airtruth::motion
