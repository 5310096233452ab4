// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/base/log.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"
#include "world/scene/scene.h"

// What a camera and its air do to light, measured from a clip alone: the values of
// scene::CameraModel, each with how sure it is, or why it cannot be had.
namespace airtruth::calibration {

namespace fs = std::filesystem;

struct Options {
  std::optional<lens::Lens> lens;  // for sun, horizon and extinction
  const image::Mask* own_aircraft = nullptr;
  std::optional<double> altitude_m;  // above the ground: with it terrain tells the extinction
  double heading_deg = 0;            // of the camera in the first frame, for the sun's azimuth
  image::ToneCurve tone;             // under which light is measured: one clip cannot tell it
  std::int64_t first_frame = 0;
  std::optional<std::int64_t> frame_count;
  Warn warn;
  std::stop_token stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// A value and its standard error.
struct Estimate {
  double value = 0;
  double sigma = 0;
};

// Noise of the luma at one brightness: what the noise curve is fitted to.
struct NoisePoint {
  double luma = 0;         // 0..1, coded
  double sigma_codes = 0;  // standard deviation of luma, code values
  int blocks = 0;
};

// The profile of a step across the sharpest edges, from 0 to 1, at places in pixels.
struct EdgeProfile {
  std::vector<double> place_px;
  std::vector<double> height;
  std::vector<double> fitted;
  double spread_px = 0;  // from 10 to 90 % of what was fitted
  int edges = 0;         // that were fitted; the profile is of those nearest to the camera
};

struct Horizon {
  std::int64_t frame = 0;
  double pitch_deg = 0;   // of the camera: up positive
  double roll_deg = 0;    // right wing down positive
  double separation = 0;  // how far apart sky and ground are, in their own standard deviations
};

struct Calibration {
  fs::path video;
  int clips = 1;  // that were measured as one (join.h)
  int width = 0;
  int height = 0;
  std::int64_t frames = 0;
  double frame_rate_hz = 0;
  std::vector<std::int64_t> cuts;  // frames that begin a shot; nothing is measured across
  std::string lens;
  image::ToneCurve tone;  // as it was given
  // By key, as in a scene: "sensor.noise_gain", "air.extinction_per_km" (three), ...
  std::map<std::string, std::vector<Estimate>> values;
  // The readout with its sign, downwards positive, before it is told from nothing; what is joined.
  std::optional<Estimate> downwards_s;
  std::map<std::string, std::string> missing;  // key: why not
  std::map<std::string, std::string> notes;    // key: what to know about the value
  // Of values that are not the clip's own alone: whose they are (profile.h).
  std::map<std::string, std::string> sources;
  std::map<std::string, std::string> doubts;  // key: what contradicts the value by more than errors
  // Of each frame: the heading of the camera, in degrees from that of the first frame, which turns
  // the sun's azimuth for a sequence that begins at a later frame. Empty without a lens or a
  // horizon.
  std::vector<double> yaw_from_first_deg;
  std::vector<NoisePoint> noise;
  EdgeProfile edge;
  std::vector<Horizon> horizons;
  std::optional<image::Rgb8> sky_picture;  // a frame with its sky tinted, for the plots
};

// Reads the clip once. Error for what is no video; a clip too short or too still gives what it
// holds.
Calibration calibrate(const fs::path& video, const Options& options);

// Is a readout a sign of a rolling shutter? Below twice its error it is none.
inline bool rolls(const Estimate& readout) { return std::abs(readout.value) > 2 * readout.sigma; }

// camera.toml: values, and as comments their errors and what is missing.
std::string toml_from(const Calibration& calibration);
scene::CameraModel model_of(const Calibration& calibration);

// Noise curve, edge profile, horizon over time, segmentation: one picture to look at.
image::Rgb8 plot(const Calibration& calibration);

// "fisheye 562.7 x 563.1 px" and the like: tells lenses apart in messages and files.
std::string lens_words(const lens::Lens& lens);

}  // namespace airtruth::calibration
