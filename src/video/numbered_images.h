// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace airtruth::video {

// Images whose names differ in one number: "frames/%06d.png" and where the numbers begin.
struct NumberedImages {
  std::string pattern;
  int first = 0;
};

// `path` is such a pattern itself, or a folder of numbered images; empty otherwise. Throws Error
// for a pattern that matches no file.
std::optional<NumberedImages> numbered_images(const std::filesystem::path& path);

}  // namespace airtruth::video
