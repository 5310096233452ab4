// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "camera/lens/lens.h"
#include "foundation/base/log.h"

namespace airtruth::lens {

// Reads a calibration by the ending of its file:
//   .json  a Gyroflow lens profile, or OpenCV's FileStorage
//   .yml, .yaml  OpenCV's FileStorage, ROS 1 and 2 camera_info, or a Kalibr camchain of one camera:
//          camera_matrix, distortion_coefficients and their common spellings, image_width and
//          image_height or image_size, and the model (fisheye_model, distortion_model, ...)
//   .xml   OpenCV's FileStorage, or an Agisoft camera calibration
//   .txt   COLMAP's cameras.txt with one camera
// The lens is scaled to `size` where the calibration was made at another size of the same aspect
// ratio (within 1 %); another aspect ratio is an Error, which names the profiles of the same camera
// in the file's folder that have the video's.
// Throws Error, which names the field, for a property that no model here has: skew, thin prism or
// tilt coefficients other than 0, a digital lens, an anamorphic stretch, other lens models; for a
// key that is not known and sounds like a lens's; and for four coefficients of which nothing says
// whether they are a fisheye's. Warns of other keys that are not read. An Error states the file,
// and the line where the format tells it.
Lens read_calibration(const std::filesystem::path& path, ImageSize size, const Warn& warn = {});

// The lens in the size that the file was made for; Error where the file states none.
Lens read_calibration(const std::filesystem::path& path);

// The same from text, for tests and fuzzing. `name` chooses the format by its extension and stands
// in messages.
Lens parse_calibration(std::string_view text,
                       const std::filesystem::path& name,
                       ImageSize size,
                       const Warn& warn = {});

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
