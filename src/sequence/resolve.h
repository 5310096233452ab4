// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"
#include "video/reader.h"

namespace airtruth::sequence {

// The scene with its camera model made out: a shutter angle as seconds. What sequence.json records,
// and what drawing a frame again needs.
scene::Scene resolved(const scene::Scene& scene, const video::StreamInfo& info);

}  // namespace airtruth::sequence
