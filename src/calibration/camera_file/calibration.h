// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <airtruth/calibration.h>

#include "calibration/camera_file/quantities.h"
#include "calibration/measured/measured.h"
#include "calibration/optics/step_response.h"
#include "calibration/sensor/noise.h"
#include "camera/lens/lens.h"
#include "foundation/base/files.h"
#include "foundation/image/picture.h"
#include "foundation/image/tone_curve.h"
#include "scene/scene/scene.h"

// The camera model and the air of a scene as they were measured, and the text of camera.toml. These
// are the values of scene::CameraModel. Each value has a standard error, or the reason why the clip
// does not show it.
namespace airtruth::camera_file {

// The result of a calibration.
struct Calibration {
  fs::path video;
  // The number of clips whose measurements were joined into this one (join.h).
  int clips = 1;
  int width = 0;
  int height = 0;
  std::int64_t frames = 0;
  double frame_rate_hz = 0;
  // Frames that begin a new shot. No pair of frames across a cut is used.
  std::vector<std::int64_t> cuts;
  std::string lens;
  // The tone curve of the options.
  image::ToneCurve tone;
  Quantities quantities;
  // The readout time of the frame in seconds with its sign, positive downwards. It is kept whether
  // or not it differs significantly from 0, since join.h combines the signed values of clips.
  std::optional<Estimate> downwards_s;
  // The direction in which the rows are read: "down" or "up"; empty if no readout is measured.
  std::string readout_direction;
  // If not every frame gives a horizon: the reason why none does, or a remark about the others.
  std::string no_horizon, horizon_note;
  // For each frame, the heading of the camera relative to that in the first frame, degrees. A
  // sequence that begins at a later frame turns the azimuth of the sun by it. Empty without a lens
  // or a horizon; it ends at the first cut.
  std::vector<double> yaw_from_first_deg;
  std::vector<sensor::NoisePoint> noise;
  optics::EdgeProfile edge;
  std::vector<HorizonAttitude> horizons;
  // A frame with its sky tinted, for the plots.
  std::optional<image::Rgb8> sky_picture;
};

// Whether a readout time differs significantly from 0 and so shows a rolling shutter: its magnitude
// exceeds twice its standard error.
inline bool rolls(const Estimate& readout) { return std::abs(readout.value) > 2 * readout.sigma; }

// The text of camera.toml: the values, with their errors and the reasons for missing values as
// comments.
std::string toml_from(const Calibration& calibration);
// The measured values as the camera model of a scene.
scene::CameraModel model_of(const Calibration& calibration);

// The name and the focal length of a lens, such as "fisheye 562.7 px", for messages and files.
std::string lens_words(const lens::Lens& lens);

}  // namespace airtruth::camera_file
