// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace airtruth::video {

// The tags of a video file and of its video stream, with keys in lower case, as cameras write them
// ("com.apple.quicktime.model", "encoder"). A stream's tag takes precedence. Throws Error where the
// file cannot be opened.
std::map<std::string, std::string> read_tags(const std::filesystem::path& path);

}  // namespace airtruth::video
