// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture/video/reader.h"
#include "world/scene/scene.h"

namespace airtruth::sequence {

// Error for all that is wrong with a scene and can be known before a frame of its clip is read: the
// mask, the lens, the camera file, the paths of camera and intruders, the aircraft's names, and
// whether the method can draw through this lens with this camera model. `info` is of the
// background, or of what will be made as such.
void check_scene(const scene::Scene& scene, const video::StreamInfo& info);

}  // namespace airtruth::sequence
