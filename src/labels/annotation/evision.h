// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
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
  Vector3 intruder_ned_m = Vector3::Zero();
  double distance_m = 0;
  // All zero: no box.
  PixelBox rect_px{};
};

// Writes a file in the form of the published ones, except for the last digit of exact halves
// (docs/formats/evision.md), frame by frame.
class EvisionWriter {
 public:
  explicit EvisionWriter(const std::filesystem::path& file);
  // An empty frame means that the intruder is not in the world (its path has not begun or is over);
  // it is written with the camera's position, an empty box, and no IntruderPos_m or Distance_m.
  void add(const std::optional<EvisionFrame>& frame, const Vector3& camera_ned_m);
  // Throws Error where anything could not be written.
  void finish();

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  int last_ = 0;  // number of the frame before
};

// Reads the published files and those of EvisionWriter. Errors carry file and line. Frames without
// IntruderPos_m are empty.
struct Evision {
  std::vector<std::optional<EvisionFrame>> frames;
  std::vector<Vector3> camera_ned_m;
};
Evision read_evision(const std::filesystem::path& file);
Evision parse_evision(std::string_view text, const std::filesystem::path& name);

}  // namespace airtruth::annotation
