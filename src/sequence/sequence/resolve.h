// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/base/log.h"
#include "foundation/image/layer.h"
#include "picture/video/reader.h"
#include "sequence/sequence/sequence.h"
#include "world/scene/scene.h"

namespace airtruth::sequence {

// A scene with what it states itself and what its camera file says; a shutter angle is in seconds.
// Keys that say "auto" are listed apart, so that all but them can be read and checked before the
// clip is measured.
struct StatedScene {
  scene::Scene scene;      // no [realism] and no "auto" left
  scene::Realism realism;  // as the scene has it
  std::vector<std::string>
      to_measure;             // camera keys ("shutter.exposure_s") that the clip must tell
  bool sun_is_known = false;  // stated, or in the camera file
};

// Error where the camera file cannot be read or is of another size or lens, and where the method
// has no place for a camera model. Reads no frame.
StatedScene stated(const scene::Scene& scene, const video::StreamInfo& info);

// The scene with its camera model complete: what sequence.json records, and what drawing a frame
// again needs. Measures the clip where a key is left to measure, which takes long. Error where one
// cannot be measured and [realism] fallback does not allow to leave it out.
scene::Scene resolved(const StatedScene& stated,
                      const lens::ImageSize& size,
                      const image::Mask* mask,
                      const Options& options);

}  // namespace airtruth::sequence
