// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

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

}  // namespace airtruth::new_scene
