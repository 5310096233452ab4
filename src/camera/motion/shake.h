// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "camera/motion/motion.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/within_frame.h"

namespace airtruth::motion {

// The weights of the ideal differentiator under a Hann window: the derivative per frame at frame 0
// is the sum over j = 1..reach of weight(j) (x[j] - x[-j]), with weight(j) = (-1)^(j + 1) / j times
// the window. `reach` is at least 1. A shake of 10 Hz at 30 frames/s keeps 0.98 of its rate at a
// large reach, where the plain difference (x[1] - x[-1]) / 2, which is used for reach = 1, keeps
// 0.41.
inline double differentiator_weight(int j, int reach) {
  if (reach == 1) return 0.5;
  const double window = 0.5 * (1 + std::cos(kPi * j / (reach + 1)));
  return (j % 2 == 1 ? 1.0 : -1.0) / j * window;
}

// The motion of each frame against a Gaussian-smoothed camera path, which is the shake, from the
// motion against the first frame.
std::vector<FrameMotion> smoothed(std::vector<FrameMotion> motion, const Options& options);

// The shake of frame k and its change per second, from the neighbouring frames. Motion blur and a
// rolling shutter are computed from it.
Shake shake_of(const std::vector<FrameMotion>& motion, std::size_t k);

}  // namespace airtruth::motion
