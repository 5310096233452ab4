// SPDX-License-Identifier: Apache-2.0
#include "sequence/sequence/scene_check.h"

#include "sequence/frame/paint.h"
#include "sequence/sequence/resolve.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/world.h"

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
