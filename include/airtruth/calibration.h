// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <airtruth/error.h>
#include <airtruth/export.h>

// What a clip's camera and air do to light, as `airtruth calibrate` measures it.
//
// Example: of a clip of sky alone, calibrate({"sky.mp4"}) has a noise of one value, and no point
// spread but that of the profile:
//   {"sensor.noise_gain", {{8.9e-05, 9.4e-06}}, "", "", "", ""}
//   {"optics.point_spread_px", {{0.42, 0.22}}, "", "", "of the median over 3 cameras; ...", ""}
namespace airtruth {

struct CalibrateOptions {
  // Calibration of the lens (Lens::from_file), which sun, horizon and extinction need, and mask of
  // the own aircraft, which is black there; empty: none.
  std::filesystem::path lens;
  std::filesystem::path mask;
  // Height of the camera above the ground, above 0; the extinction needs it.
  std::optional<double> altitude_m;
  // Where the camera looks in the first frame, from north, -360 to 360; the sun needs it.
  double heading_deg = 0;
  // Exponent of the camera's tone curve, 1.2 to 3; 0: sRGB's curve.
  double gamma = 0;
  // A name of camera_profiles(), for what the clip does not show; "none": the clip's values alone;
  // empty: the one that the first clip's tags and size tell, else the median over all.
  std::string profile;
  // Of numbered pictures, which state none.
  std::optional<double> frame_rate_hz;
  Warn warn;
  // As in MotionOptions.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  // calibrate() throws Interrupted once a stop is requested.
  std::stop_token stop;
};

struct Estimate {
  double value = 0;
  // Standard error.
  double sigma = 0;

  bool operator==(const Estimate&) const = default;
};

// One quantity of a camera file.
struct CalibratedQuantity {
  // Table and key of a scene file: "optics.point_spread_px". docs/formats/camera.md has the units.
  std::string name;
  // One, or three (red, green, blue); none where the quantity is not measured.
  std::vector<Estimate> values;
  // Why it is not measured.
  std::string missing;
  // A remark about the value.
  std::string note;
  // Where it comes from, if not from these clips alone.
  std::string source;
  // A measurement that contradicts the value by more than the errors allow.
  std::string doubt;
};

struct HorizonAttitude {
  std::int64_t frame = 0;
  // Positive upwards, and with the right wing down.
  double pitch_deg = 0;
  double roll_deg = 0;
};

struct Calibration {
  int width = 0;
  int height = 0;
  double frame_rate_hz = 0;
  std::int64_t frames = 0;
  int clips = 0;
  // In the order of a camera file.
  std::vector<CalibratedQuantity> quantities;
  // "down" or "up"; empty where no readout is measured.
  std::string readout_direction;
  // Of one clip with a lens; why there are none, or a remark.
  std::vector<HorizonAttitude> horizons;
  std::string no_horizon;
  std::string horizon_note;
  // The camera file that `airtruth calibrate` writes.
  std::string toml;
};

// Measures a clip, or several of one camera, which then have optics, sensor and shutter alone.
// Throws Error for a file that cannot be read, for clips of several sizes, and for options out of
// their range. What the clips do not show is no error.
AIRTRUTH_API Calibration calibrate(const std::vector<std::filesystem::path>& videos,
                                   const CalibrateOptions& options = {});

// A camera whose values are known.
struct CameraProfile {
  std::string name;
  // Its description.
  std::string camera;
  // Size of its pictures, px, and number of clips that it was measured on.
  int width = 0;
  int height = 0;
  int clips = 0;
};
AIRTRUTH_API std::vector<CameraProfile> camera_profiles();

}  // namespace airtruth
