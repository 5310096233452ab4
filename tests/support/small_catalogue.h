// SPDX-License-Identifier: Apache-2.0
#pragma once

// The catalogue of the tests of data sets: four sequences of eight small frames, coded without
// loss.
namespace airtruth::test_support {

constexpr const char* kCatalogue = R"(
name = "small"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 8, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150] }
[[background]]
name = "more"
flight = { seed = 4, frame_count = 8, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150] }
[[aircraft]]
name = "b737"
aircraft = "738/738-Ryanair"
[[aircraft]]
name = "c172"
aircraft = "c172/news"
[[trajectory]]
name = "across"
waypoints_ned_m = [[150, -20, -160], [150, 60, -160]]
speed_mps = 60
[[product]]
name = "{background}-{trajectory}-{aircraft}"
[output]
video = "mkv"
)";

}  // namespace airtruth::test_support
