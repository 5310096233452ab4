// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "camera/motion/differentiator.h"
#include "camera/motion/motion.h"
#include "foundation/base/error.h"

namespace airtruth::motion {

namespace {

constexpr int kReach = 8;

bool is_away(const FrameMotion& motion) { return motion.state == State::kTurnedAway; }

// Whether frame i continues the frame before it. It does not after a cut, nor where a held motion
// is next to a measured one.
bool goes_on(const std::vector<FrameMotion>& motion, std::size_t i) {
  return motion[i].state != State::kCut && is_away(motion[i]) == is_away(motion[i - 1]);
}

// The number of frames on each side of k that are linked to it at equal intervals; at most kReach.
int linked_reach(const std::vector<FrameMotion>& motion, std::size_t k) {
  int reach = 0;
  const double step_s = k + 1 < motion.size() ? motion[k + 1].time_s - motion[k].time_s : 0;
  while (reach < kReach) {
    const auto next = static_cast<std::size_t>(reach) + 1;
    if (k < next || k + next >= motion.size()) break;
    if (!goes_on(motion, k + next) || !goes_on(motion, k - next + 1)) break;
    const double after_s = motion[k + next].time_s - motion[k + next - 1].time_s;
    const double before_s = motion[k - next + 1].time_s - motion[k - next].time_s;
    if (std::abs(after_s - step_s) > 0.02 * step_s || std::abs(before_s - step_s) > 0.02 * step_s)
      break;
    ++reach;
  }
  return reach;
}

}  // namespace

Shake shake_of(const std::vector<FrameMotion>& motion, std::size_t k) {
  check(k < motion.size(), "a frame that was measured");
  const FrameMotion& now = motion[k];
  Shake shake{now.frame_from_reference, Homography::Zero(), now.rotation, Vector3::Zero()};
  const auto add = [&](std::size_t i, double per_s) {
    if (now.rotation)
      shake.rate_radps +=
          per_s * vector_from_rotation(*motion[i].rotation * now.rotation->conjugate());
    else
      shake.frame_from_reference_per_s +=
          per_s * (motion[i].frame_from_reference - now.frame_from_reference);
  };
  const int reach = linked_reach(motion, k);
  if (reach > 0) {
    const double step_s = motion[k + 1].time_s - now.time_s;
    for (int j = 1; j <= reach; ++j) {
      const auto offset = static_cast<std::size_t>(j);
      add(k + offset, differentiator_weight(j, reach) / step_s);
      add(k - offset, -differentiator_weight(j, reach) / step_s);
    }
    return shake;
  }
  // At an end of the linked frames only one neighbour remains.
  if (k + 1 < motion.size() && goes_on(motion, k + 1))
    add(k + 1, 1 / (motion[k + 1].time_s - now.time_s));
  else if (k > 0 && goes_on(motion, k))
    add(k - 1, -1 / (now.time_s - motion[k - 1].time_s));
  return shake;
}

}  // namespace airtruth::motion
