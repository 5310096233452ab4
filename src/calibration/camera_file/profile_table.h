// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace airtruth::camera_file {

// The text of all data/camera-profiles/*.csv, embedded when the program is built. A line
// "profile,NAME" precedes the text of each file.
std::string_view profile_table();

}  // namespace airtruth::camera_file
