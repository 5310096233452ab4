// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "camera/lens/lens.h"

namespace airtruth::lens {

// The lens of a picture that is cropped in the middle to another aspect ratio and then scaled to
// `size` with square pixels, as cameras crop 16:9 from a 4:3 sensor. The crop is the largest that
// fits. The direction of each remaining pixel is unchanged; the principal point moves with the
// crop.
Lens cropped(const Lens& lens, ImageSize size);

// The text of an OpenCV calibration file (YAML). read_calibration() reads the same lens from it
// exactly, except for the angle at which a fisheye's calibration ends, for which OpenCV has no
// field. `note` becomes a comment of one line.
std::string opencv_calibration(const Lens& lens, const std::string& note);

// The lens as the [lens] table of a scene, one key per line.
std::string scene_table(const Lens& lens);

}  // namespace airtruth::lens
