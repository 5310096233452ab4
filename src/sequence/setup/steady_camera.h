// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "scene/trajectory/path.h"

namespace airtruth::setup {

// The camera's path about which the measured motion is its shake ([motion] reference "smoothed").
//
// The attitudes of a path file or a log are those that the camera had. The measured shake of a
// frame is its turn against the mean of the frames around it (motion::smoothed()), so that each
// attitude is replaced by the mean, by the same window, of those that the path has at the clip's
// frames. Mean and shake together are the path's attitude. Beside the clip's first and last frame
// the window is one-sided for both.
//
// `clip` is the part of the video that the scene uses. Returns the path as it is where the motion
// is not smoothed, or where nothing but the scene's own numbers state an attitude.
trajectory::Path steady_camera(const trajectory::Path& path,
                               const scene::Scene& scene,
                               const video::StreamInfo& clip);

}  // namespace airtruth::setup
