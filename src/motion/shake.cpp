// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "motion/motion.h"

namespace airtruth::motion {

Shake shake_of(const std::vector<FrameMotion>& motion, std::size_t k) {
  check(k < motion.size(), "a frame that was measured");
  const FrameMotion& now = motion[k];
  Shake shake{now.frame_from_reference, Homography::Zero(), now.rotation, Vector3::Zero()};
  // The neighbours that the scene links to this frame.
  const bool has_before = k > 0 && now.state != State::kCut;
  const bool has_after = k + 1 < motion.size() && motion[k + 1].state != State::kCut;
  const FrameMotion& before = has_before ? motion[k - 1] : now;
  const FrameMotion& after = has_after ? motion[k + 1] : now;
  const double dt_s = after.time_s - before.time_s;
  if (!(dt_s > 0)) return shake;
  if (now.rotation)
    shake.rate_radps = vector_from_rotation(*after.rotation * before.rotation->conjugate()) / dt_s;
  else
    shake.frame_from_reference_per_s =
        (after.frame_from_reference - before.frame_from_reference) / dt_s;
  return shake;
}

}  // namespace airtruth::motion
