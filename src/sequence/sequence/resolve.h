// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/base/log.h"
#include "foundation/image/layer.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "sequence/sequence/sequence.h"

namespace airtruth::sequence {

// A scene combined with its camera file; a shutter angle is converted to seconds. Keys with the
// value "auto" are listed separately, so that all others can be checked before the clip is
// measured.
struct StatedScene {
  scene::Scene scene;      // no [realism] and no "auto" left
  scene::Realism realism;  // as the scene states it
  std::vector<std::string>
      // Camera keys ("shutter.exposure_s") that must be measured on the clip.
      to_measure;
  bool sun_is_known = false;  // stated in the scene or in the camera file
};

// Reads no frame. Throws Error where the camera file cannot be read or is for another size or lens,
// and where the method does not support a camera model.
StatedScene stated(const scene::Scene& scene, const video::StreamInfo& info);

// Returns the scene with its camera model complete, as sequence.json records it and as rendering a
// frame again requires it. Measures the clip where a key is still unknown, which takes long. Throws
// Error where a key cannot be measured and [realism] fallback does not allow leaving it out.
scene::Scene resolved(const StatedScene& stated,
                      const lens::ImageSize& size,
                      const image::Mask* mask,
                      const Options& options);

}  // namespace airtruth::sequence
