// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture/video/reader.h"
#include "scene/scene/scene.h"

namespace airtruth::sequence {

// Throws Error for every fault of a scene that can be found before a frame of its clip is read: in
// the mask, the lens, the camera file, the paths of camera and intruders, the aircraft's names, and
// where the method cannot render through this lens with this camera model. `info` describes the
// background, or the one that will be made.
void check_scene(const scene::Scene& scene, const video::StreamInfo& info);

}  // namespace airtruth::sequence
