// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "encounter/separation/measures.h"
#include "encounter/separation/volumes.h"

namespace airtruth::detection {

// The own aircraft and an intruder at one frame.
struct PairState {
  double time_s = 0;
  encounter::Mover own;
  encounter::Mover intruder;
};

// The first time at which the states violate the volume: within the frames, between which positions
// and velocities are interpolated, or within `lookahead_s` after the last of them, from which on
// both keep their velocities. Empty where they never do. For volumes that the scene did not ask
// for; sequence.json states the violations of the others along the whole paths.
std::optional<double> first_violation_s(const encounter::Volume& volume,
                                        std::span<const PairState> states,
                                        double lookahead_s);

}  // namespace airtruth::detection
