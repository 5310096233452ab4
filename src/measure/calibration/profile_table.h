// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace airtruth::calibration {

// data/camera-profiles/*.csv, put into the program when it is built: before each file a line
// "profile,NAME".
std::string_view profile_table();

}  // namespace airtruth::calibration
