// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "camera/motion/motion.h"

// Where a camera holds its direction: there an intruder on a straight path stays in view.
namespace airtruth::sequence {

struct Stretch {
  std::size_t first = 0;  // index in the motion
  std::size_t frames = 0;
};

// The longest stretch of at most `most` frames in which the camera's attitude stays within
// `turn_rad` of that in the stretch's first frame, without a cut; the earliest of equally long
// ones. `motion` is of the model rotation, against one reference.
//
// Example: a camera that turns by 1 degree in each of 100 frames, holds still for 50 and turns on:
// with 10 degrees the stretch begins at frame 90, 10 degrees before it holds still, and has 60
// frames. One that begins at frame 100 has 60 too, but is later.
Stretch steady_stretch(const std::vector<motion::FrameMotion>& motion,
                       double turn_rad,
                       std::size_t most);

}  // namespace airtruth::sequence
