// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace airtruth::video {

// The pictures of a clip that is stored as one file for each frame, in the order of the frames.
struct NumberedImages {
  // At least one file.
  std::vector<std::filesystem::path> files;
  // True where a number between the first and the last is missing.
  bool has_gaps = false;
};

// `path` is a folder of pictures, or a pattern of their names such as "frames/%06d.png"; the result
// is empty for anything else. In a folder, pictures whose names differ only in their last number
// (img_7.png, img_08.png, 000000000139.jpg) are taken in the order of that number where they are
// more than half of the folder's pictures. Otherwise all pictures of one ending are taken in the
// order of their names, with every run of digits compared as a number (Airborne Object Tracking's
// TIMEFLIGHT.png). Throws Error for a pattern that matches no file.
std::optional<NumberedImages> numbered_images(const std::filesystem::path& path);

}  // namespace airtruth::video
