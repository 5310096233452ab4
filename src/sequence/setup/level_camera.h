// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"

namespace airtruth::setup {

// How many frames of a scene's beginning are read to find its horizon, and every how many of them
// one is looked at. They are enough for a median, and 0.7 s of a clip of 30 frames/s.
inline constexpr std::int64_t kLevelFrames = 21;
inline constexpr std::int64_t kLevelEvery = 5;
// A camera that nothing states to be upside down is not: a bright field below dark clouds or a test
// pattern looks like it.
inline constexpr double kMostRollDeg = 90;

// The level attitude, with the heading of its path or log, of a camera for which neither the scene
// nor its path or log states one; empty where one does.
std::optional<YawPitchRoll> level_attitude(const scene::Camera& camera);

// By how much the horizon that the first frame shows lies below the horizontal: its dip from the
// height of the path there.
double first_dip_rad(const scene::Camera& camera);

// States the attitude of a camera for which neither the scene nor its path or log does: pitch and
// roll of the first frame are the median of the horizons in the first kLevelFrames frames, each
// carried to the first by the rotation that is measured between them
// (calibration/camera_file/level.h) and raised by its dip. Yaw stays. Where these frames show no
// horizon, or one that stands upside down, the camera is level. Returns what was done in words, for
// the user; "" where the attitude was stated or need not be found.
//
// `open` gives a reader from the scene's first frame on, and is called where frames are needed.
std::string state_attitude(scene::Camera& camera,
                           const lens::Lens& lens,
                           const image::Mask* own_aircraft,
                           const std::function<video::Reader()>& open,
                           const std::stop_token& stop = {});

}  // namespace airtruth::setup
