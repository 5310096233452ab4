// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "camera/lens/lens.h"

namespace airtruth::lens {

// Reads a calibration: a Gyroflow lens profile (.json), or an OpenCV calibration (.yml, .yaml,
// .xml) with camera_matrix, distortion_coefficients (or their common spellings: cameraMatrix, K,
// dist_coeffs, D, ...), image_width, image_height and, for a fisheye, fisheye_model or a
// 4-coefficient model said to be fisheye. The lens is scaled to `size` where the calibration was
// made at another size of the same aspect ratio (within 1 %); another aspect ratio is an Error,
// which names the profiles of the same camera in the file's folder that have the video's.
// Throws Error, which names the field, for a property that no model here has: skew, thin prism or
// tilt coefficients other than 0, a digital lens, an anamorphic stretch and others. An Error states
// the file, and the line where the format has lines.
// the line where the format tells it.
Lens read_calibration(const std::filesystem::path& path, ImageSize size);

// The lens in the size that the file was made for; Error where the file states none.
Lens read_calibration(const std::filesystem::path& path);

// The same from text, for tests and fuzzing. `name` chooses the format by its extension and stands
// in messages.
Lens parse_calibration(std::string_view text, const std::filesystem::path& name, ImageSize size);

}  // namespace airtruth::lens
