// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include <airtruth/error.h>

#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "picture/composite/cover.h"
#include "scene/scene/scene.h"
#include "sequence/setup/moment.h"

namespace airtruth::insertion {

// What stands before the intruders of a scene: the own aircraft, and each [[occluder]]. Copies
// share what they read. Threads may use it at the same time.
class Occluders {
 public:
  // Of the own aircraft alone, which may be null and must outlive this.
  explicit Occluders(const image::Mask* own_aircraft = nullptr);
  // `frames`: how many the scene uses of its clip; 0: unknown. Throws Error where a mask
  // cannot be read, is of another size or hides nothing, and where a series of masks ends before
  // the scene. Warns of a mask without black, as one of a video's limited range is.
  Occluders(const scene::Scene& scene,
            const lens::Lens& lens,
            const image::Mask* own_aircraft,
            std::int64_t frames,
            const Warn& to_warn = {});

  struct InFrame {
    composite::Occlusion occlusion;
    // True where the picture shows no horizon, and it is put where the camera's attitude has it.
    bool horizon_is_assumed = false;
  };
  // `picture`: the background's. A mask or a horizon that no intruder in view is behind is left
  // out. Throws Error where a mask of a series cannot be read or is of another size.
  InFrame in_frame(const setup::Moment& moment, const image::Picture& picture) const;

  const image::Mask* own_aircraft() const;
  // True where the scene has an [[occluder]].
  bool has_others() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace airtruth::insertion
