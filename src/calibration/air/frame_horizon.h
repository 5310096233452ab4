// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace airtruth::calibration {

// The horizon found in one frame.
struct FrameHorizon {
  std::int64_t frame = 0;
  // Pitch of the camera, positive upwards.
  double pitch_deg = 0;
  // Roll of the camera, positive with the right wing down.
  double roll_deg = 0;
  // The distance between the colours of sky and ground, in their standard deviations.
  double separation = 0;
};

}  // namespace airtruth::calibration
