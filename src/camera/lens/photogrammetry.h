// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "camera/lens/calibration.h"

// Cameras as photogrammetry programs write them.
namespace airtruth::lens {

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
