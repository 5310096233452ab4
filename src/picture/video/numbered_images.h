// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace airtruth::video {

// The pictures of a clip that is stored as one file a frame, in the order of the frames.
struct NumberedImages {
  std::vector<std::filesystem::path> files;  // at least one
  bool has_gaps = false;                     // a number between the first and the last is missing
};

// `path` is a folder of pictures, or a pattern of their names such as "frames/%06d.png"; empty
// where it is neither. Of a folder: the pictures whose names differ in one last number alone
// (img_7.png, img_08.png, 000000000139.jpg), in the order of that number, where these are more than
// half of the folder's pictures; else all of one ending, in the order of their names with every run
// of digits compared as a number (Airborne Object Tracking's TIMEFLIGHT.png). Throws Error for a
// pattern that matches no file.
std::optional<NumberedImages> numbered_images(const std::filesystem::path& path);

}  // namespace airtruth::video
