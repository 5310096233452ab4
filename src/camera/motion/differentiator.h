// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "foundation/geometry/transform.h"

namespace airtruth::motion {

// Weights of the ideal differentiator under a Hann window: (-1)^(j + 1) / j for the frames j after
// and before, 1 to reach, per frame. A shake of 10 Hz in 30 frames/s keeps 0.98 of its rate, where
// a plain difference keeps 0.41; with one frame to each side it is that difference.
inline double differentiator_weight(int j, int reach) {
  if (reach == 1) return 0.5;
  const double window = 0.5 * (1 + std::cos(kPi * j / (reach + 1)));
  return (j % 2 == 1 ? 1.0 : -1.0) / j * window;
}

}  // namespace airtruth::motion
