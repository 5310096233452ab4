// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "camera/lens/lens.h"

// The content that all kinds of calibration files have in common, in the file's own image size and
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

// COLMAP's cameras.txt (colmap.github.io, "Output Format"): CAMERA_ID MODEL WIDTH HEIGHT PARAMS.
// The models are SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV,
// SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE and OPENCV_FISHEYE (colmap/src/colmap/sensor/models.h). The
// first pixel's centre is at 0.5. Throws Error, with the line, for other models and for several
// cameras.
Calibration parse_colmap_cameras(std::string_view text, const std::filesystem::path& name);

// Agisoft Metashape's camera calibration (user manual, appendix D "Camera models"): a <calibration>
// with f, cx and cy from the middle of the picture, b1 (fx - fy), k1 to k4, p1 and p2, which are
// OpenCV's p2 and p1. The projection is `frame` or `fisheye`. Throws Error for other projections,
// for b2 (skew), and for k4 or tangential terms where the model here has none.
Calibration parse_agisoft_calibration(std::string_view text, const std::filesystem::path& name);

}  // namespace airtruth::lens
