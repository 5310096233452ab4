// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "camera/motion/motion.h"
#include "foundation/geometry/within_frame.h"
#include "scene/scene/scene.h"

namespace airtruth::new_scene {

// The words of an [[intruder]] with an encounter that is in view for most of a clip: of a few
// common ones (head-on, from the left, from the right, overtaken) the one whose reference point is
// in the picture longest. `shake_at` is the camera's measured motion at a time of the clip.
std::string first_encounter(const lens::Lens& lens,
                            const scene::Camera& camera,
                            double duration_s,
                            const std::function<Shake(double time_s)>& shake_at);

// Where a camera holds its direction: there an intruder on a straight path stays in view.

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

}  // namespace airtruth::new_scene
