// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "camera/lens/lens.h"

namespace airtruth::lens {

// The lens of the middle of a picture, cut to another aspect ratio and scaled to `size` without
// squeezing: the largest part of that shape, as cameras cut 16:9 out of 4:3. Directions keep their
// place in the scene; the principal point moves with the cut.
Lens cropped(const Lens& lens, ImageSize size);

// An OpenCV calibration file (YAML) that read_calibration() reads as the same lens to the last
// digit that doubles have, but for the angle at which a fisheye's own file says that its curve
// ends: OpenCV has no field for it. `note` becomes a comment of one line.
std::string opencv_calibration(const Lens& lens, const std::string& note);

// The lens as a scene's [lens] table, a line a key.
std::string scene_table(const Lens& lens);

}  // namespace airtruth::lens
