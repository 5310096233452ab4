// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/log.h"
#include "image/layer.h"
#include "scene/scene.h"
#include "sequence/sequence.h"
#include "video/reader.h"

namespace airtruth::sequence {

// The scene with its camera model made out, in this order: what it states; what its camera file
// says; what is measured from the clip, for keys that say "auto" and, with [realism] auto, for all.
// A shutter angle becomes seconds. What sequence.json records, and what drawing a frame again
// needs. Error where the camera file is of another size or lens, and where what was asked for
// cannot be measured and [realism] fallback does not allow to leave it out.
scene::Scene resolved(const scene::Scene& scene,
                      const video::StreamInfo& info,
                      const image::Mask* mask,
                      const Options& options);

}  // namespace airtruth::sequence
