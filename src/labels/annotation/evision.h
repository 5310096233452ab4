// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"

// The annotation format of the E-Vision paper (section II.E): OpenCV FileStorage XML with, for each
// frame_N (N from 1), CameraPos_m, IntruderPos_m, Distance_m and IntruderRect_pix (x, y, width,
// height; 0,0,0,0 where there is no box).
namespace airtruth::annotation {

struct EvisionFrame {
  // The N of frame_N.
  int number = 1;
  Vector3 camera_ned_m = Vector3::Zero();
  Vector3 intruder_ned_m = Vector3::Zero();
  double distance_m = 0;
  // All zero: no box.
  PixelBox rect_px{};
};

// Text in the form of the published files, except for the last digit of exact halves
// (docs/formats/evision.md). An empty frame means that the intruder is not in the world (its path
// has not begun or is over); it is written with the camera's position, an empty box, and no
// IntruderPos_m or Distance_m.
std::string evision_xml(const std::vector<std::optional<EvisionFrame>>& frames,
                        const std::vector<Vector3>& camera_ned_m);

// Reads the published files and those of evision_xml(). Errors carry file and line. Frames without
// IntruderPos_m are empty.
struct Evision {
  std::vector<std::optional<EvisionFrame>> frames;
  std::vector<Vector3> camera_ned_m;
};
Evision read_evision(const std::filesystem::path& file);
Evision parse_evision(std::string_view text, const std::filesystem::path& name);

}  // namespace airtruth::annotation
