// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace airtruth::video {

// The pictures of a clip that is stored as one file for each frame, in the order of the frames.
struct NumberedImages {
  // At least one file.
  std::vector<std::filesystem::path> files;
  // What makes it doubtful that these are a clip's frames in their order, for a warning: "gaps
  // between the numbers"; nullptr: nothing.
  const char* doubt = nullptr;
};

// `path` is a folder of pictures, a pattern of their names such as "frames/%06d.png", or a list of
// pictures: a text file (.txt) with a path on each line, relative to its own folder, in the order
// of the frames. The result is empty for anything else. The pictures of a folder are one series
// (foundation/picture_series/series.h) and are taken in the order of their names, with runs of
// digits as numbers. Throws Error for a folder of several series, for a pattern that matches no
// file, and for a line of a list that is no picture's path.
std::optional<NumberedImages> numbered_images(const std::filesystem::path& path);

// What is made of a video is named by this.
//
//   clip_name("pics.mp4") == clip_name("pics/") == clip_name("pics/%06d.png") == "pics"
std::string clip_name(const std::filesystem::path& video);

}  // namespace airtruth::video
