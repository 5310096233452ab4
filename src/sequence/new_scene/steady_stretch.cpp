// SPDX-License-Identifier: Apache-2.0
#include "sequence/new_scene/steady_stretch.h"

#include <algorithm>

namespace airtruth::sequence {

Stretch steady_stretch(const std::vector<motion::FrameMotion>& motion,
                       double turn_rad,
                       std::size_t most) {
  const auto rotation = [&](std::size_t k) {
    return motion[k].rotation.value_or(Quaternion::Identity());
  };
  Stretch longest;
  for (std::size_t first = 0; first < motion.size() && longest.frames < most; ++first) {
    const Quaternion at_first = rotation(first);
    std::size_t end = first + 1;
    while (end < motion.size() && end - first < most && motion[end].state != motion::State::kCut &&
           at_first.angularDistance(rotation(end)) <= turn_rad)
      ++end;
    if (end - first > longest.frames) longest = {first, end - first};
  }
  return longest;
}

}  // namespace airtruth::sequence
