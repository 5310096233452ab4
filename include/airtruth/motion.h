// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <airtruth/error.h>
#include <airtruth/export.h>
#include <airtruth/lens.h>

// How a clip's camera moved, as `airtruth motion` measures it: against the first frame or the
// smoothed path of the camera, as a rotation through a known lens or as one plane map a frame.
//
// Example: a pinhole of 1920 x 1080 pixels and a focal length of 1662.8 px turns right by 1 degree.
// A far point moves from the centre (960, 540) to (931.0, 540); the homography of that frame maps
// the one to the other.
namespace airtruth {

struct MotionOptions {
  // "rotation", which needs a lens; "homography", which knows none; "auto": whichever fits.
  std::string model = "auto";
  // Calibration (Lens::from_file), and mask of the own aircraft, which is black there; empty: none.
  std::filesystem::path lens;
  std::filesystem::path mask;
  // "first_frame", or "smoothed": the path of the camera under a Gaussian window of this standard
  // deviation.
  std::string reference = "first_frame";
  double smoothing_s = 1;
  // Of numbered pictures, which state none.
  std::optional<double> frame_rate_hz;
  // As in RenderOptions, whose measured motion is the same.
  bool use_cache = true;
  std::filesystem::path cache;
  Warn warn;
  // Called as frames are measured, from the thread of measure_motion(); total is 0 where the number
  // of frames is unknown.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  // measure_motion() throws Interrupted once a stop is requested.
  std::stop_token stop;
};

struct FrameMotion {
  std::int64_t frame = 0;
  double time_s = 0;
  // Row by row: p_in_frame ~ H p_in_reference, in pixels. The identity where the motion is a
  // rotation.
  std::array<double, 9> frame_from_reference{};
  // Quaternion w, x, y, z; empty where the motion is a homography.
  std::optional<std::array<double, 4>> cam_from_reference_cam;
  std::int64_t inliers = 0;
  // Root mean square of the inliers' errors.
  double rms_px = 0;
  // "reference" (the first frame), "measured", "bridged" (taken from its neighbours), "cut" (begins
  // a shot) or "turned_away" (beyond the reach of a homography).
  std::string state;
};

// How a gyroscope in the video's telemetry agrees with the measured rotation, and bridges it.
struct GyroAgreement {
  double correlation = 0;
  // Time of the gyroscope minus time of the video.
  double offset_s = 0;
  double rms_dps = 0;
};

struct ClipMotion {
  int width = 0;
  int height = 0;
  // Of a rotation; empty: the motion is homographies.
  std::optional<Lens> lens;
  std::vector<FrameMotion> frames;
  // Empty without a gyroscope that agrees.
  std::optional<GyroAgreement> gyro;
};

// Throws Error for a file that cannot be read and for options that do not fit together.
AIRTRUTH_API ClipMotion measure_motion(const std::filesystem::path& video,
                                       const MotionOptions& options = {});

}  // namespace airtruth
