// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "camera/lens/lens.h"

// The content that both kinds of calibration files have in common, in the file's own image size and
// in OpenCV's integer-centred pixels.
namespace airtruth::lens {

struct Calibration {
  bool fisheye = false;
  std::array<double, 9> camera_matrix{};  // row by row
  std::vector<double> distortion;
  ImageSize size;
  double max_angle_rad = kPi;  // where the file of a fisheye states it
  std::string camera;          // "GoPro Hero3+Black"; empty where the file names none
  // Sentences about keys of the file that are neither used nor harmless.
  std::vector<std::string> unread = {};
};

Calibration parse_gyroflow_profile(std::string_view text, const std::filesystem::path& name);
Calibration parse_opencv_calibration(std::string_view text, const std::filesystem::path& name);

}  // namespace airtruth::lens
