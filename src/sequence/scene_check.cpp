// SPDX-License-Identifier: Apache-2.0
#include "sequence/scene_check.h"

#include "sequence/motion_source.h"
#include "sequence/paint.h"
#include "sequence/resolve.h"
#include "sequence/world.h"

namespace airtruth::sequence {

void check_scene(const scene::Scene& scene, const video::StreamInfo& info) {
  const lens::ImageSize size{info.width, info.height};
  read_mask(scene, size);
  const StatedScene with_camera = stated(scene, info);
  const lens::Lens lens = lens_of(scene.lens, size);
  motion_model(scene);
  check_method(scene, lens);
  check_paths(with_camera.scene, info);
}

}  // namespace airtruth::sequence
