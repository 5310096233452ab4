// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include <airtruth/calibration.h>

#include "calibration/camera_file/calibration.h"
#include "camera/lens/lens.h"
#include "foundation/base/log.h"
#include "foundation/image/layer.h"
#include "foundation/image/tone_curve.h"

// Measures the camera model and the air of a scene from a video clip alone: point spread,
// sharpening, noise, exposure, rolling shutter, codec step, airlight, extinction and sun.
// calibration.h has the result.
namespace airtruth::camera_file {

struct Options {
  // The lens of the camera. Sun, horizon and extinction need it.
  std::optional<lens::Lens> lens;
  // Pixels that show the own aircraft; nullptr if none do. It must outlive the call.
  const image::Mask* own_aircraft = nullptr;
  // Height of the camera above the ground, metres. The extinction needs it.
  std::optional<double> altitude_m;
  // Heading of the camera in the first frame, degrees. The azimuth of the sun is relative to it.
  double heading_deg = 0;
  // Of numbered pictures, which state none.
  std::optional<double> picture_rate_hz;
  // The camera's tone curve. It is an input because one clip does not determine it.
  image::ToneCurve tone;
  Warn warn;
  std::stop_token stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// Measures the clip in one pass over its frames. Throws Error if the file is not a video. What a
// clip is too short or too still to show is not measured (Quantities).
Calibration calibrate(const fs::path& video, const Options& options);

// Measures the clips of one camera, joins them (join.h) and combines them with a profile
// (profile.h). Throws Error for options out of their range, clips that cannot be joined and a
// profile of another size.
Calibration calibrate_camera(const std::vector<fs::path>& clips, const CalibrateOptions& options);

}  // namespace airtruth::camera_file
