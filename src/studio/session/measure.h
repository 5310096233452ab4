// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <set>
#include <string>

#include "scene/scene/scene.h"
#include "sequence/setup/motion_source.h"

// What can be measured only in a pass over the clip, and what it depends on.
namespace airtruth::session {

struct Measured {
  // The motion of every frame, and the motion_key() of its scene.
  std::shared_ptr<const setup::MotionSource> motion;
  std::string motion_key;
  // The calibration_key() of the calibrations that are in the cache.
  std::set<std::string> calibrated;
};

// The text of a scene that has the background alone, and what `take` puts into it: the same for two
// scenes exactly where all of that is.
template <typename Take>
std::string key_of(const scene::Scene& scene, const Take& take) {
  scene::Scene part;
  part.seed = scene.seed;
  part.background = scene.background;
  take(part);
  return scene::toml_from_scene(part);
}

// Text that is the same for two scenes exactly where the measurement is.
std::string motion_key(const scene::Scene& scene);
std::string calibration_key(const scene::Scene& scene);

}  // namespace airtruth::session
