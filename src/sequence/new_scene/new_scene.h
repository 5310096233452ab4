// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "camera/lens/lens.h"
#include "camera/motion/motion.h"
#include "foundation/base/log.h"

// A first scene for a video: what its files and its picture tell, and a first encounter.
namespace airtruth::new_scene {

struct NewSceneOptions {
  // Calibration of the camera; empty: the lens is looked for.
  std::optional<std::filesystem::path> lens;
  // Of numbered pictures, in frames a second.
  std::optional<double> picture_rate_hz;
  // The folder of the scene file, to which the files in it are relative; empty: they are absolute.
  std::optional<std::filesystem::path> folder;
  // False: nothing flies yet.
  bool has_encounter = true;
  Warn warn;
  std::stop_token stop;
  std::function<void(std::int64_t done, std::int64_t total)> progress;
};

// The text of a commented scene file for the video, which parses and renders as it is.
//
// The lens is, in this order, the stated calibration; the view that a GoPro's telemetry states; the
// focal length in DJI's subtitles beside the video or in the video's tags; the result of
// LensEstimator with its interval, where it is certain; else a view of 60 degrees, or the estimate
// that is not certain where its interval does not hold that view, marked as a guess. Pitch and roll
// of the camera are those of the horizon in the first frame, where one is found. A log with
// positions (DJI's subtitles, a GoPro's telemetry) gives the own path. Where the camera turns away
// from its first direction, the scene begins where it holds one longest, in the video's first
// minute. The encounter is one of a few common ones, the one that is in view longest.
//
// Throws Error where the video cannot be read, where picture_rate_hz is missing for pictures or is
// given for a video, and Interrupted on stop.
std::string scene_text(const std::filesystem::path& video, const NewSceneOptions& options);

// What a video's own files state about its lens.

// The focal length in the text of DJI's subtitles, [focal_len: 240]: tenths of a millimetre where
// it is above 100, for a picture of 35 mm film. Empty where the text has none.
std::optional<double> equivalent_mm_in_subtitles(std::string_view text);

// The diagonal view in degrees that a GoPro's telemetry states (ZFOV); empty where it has none.
std::optional<double> diagonal_view_deg(std::span<const std::uint8_t> packet);

// A pinhole with the focal length that gives the same diagonal view on 35 mm film, whose diagonal
// is 43.27 mm.
lens::Lens pinhole_from_equivalent(double equivalent_mm,
                                   lens::ImageSize size,
                                   double width_of_height = 1);

// An equidistant fisheye with a diagonal view.
lens::Lens fisheye_from_diagonal(double view_deg, lens::ImageSize size, double width_of_height = 1);

// Where a camera holds its direction: there an intruder on a straight path stays in view.

struct Stretch {
  std::size_t first = 0;  // index in the motion
  std::size_t frames = 0;
};

// The longest stretch of at most `most` frames in which the camera's attitude stays within
// `turn_rad` of that in the stretch's first frame, without a cut; the earliest of equally long
// ones. `motion` is of the model rotation, against one reference.
//
// Example: a camera that turns by 1 degree in each of 100 frames, holds still for 50 and turns on:
// with 10 degrees the stretch begins at frame 90, 10 degrees before it holds still, and has 60
// frames. One that begins at frame 100 has 60 too, but is later.
Stretch steady_stretch(const std::vector<motion::FrameMotion>& motion,
                       double turn_rad,
                       std::size_t most);

}  // namespace airtruth::new_scene
