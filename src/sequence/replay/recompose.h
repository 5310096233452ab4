// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "sequence/replay/finished.h"

namespace airtruth::replay {

// Renders every n-th frame of a finished sequence again, from its record, its background and the
// motion in its truth, and compares the results. The truth line must be equal; a lossless video
// must be equal sample by sample; a lossy video may differ around the intruder no more than its
// codec's error elsewhere. Each fault is one line. `compared` counts the compared frames.
struct Recomposition {
  std::int64_t compared = 0;
  std::vector<std::string> faults;
};
Recomposition recompose(const Finished& sequence, std::int64_t every, const std::stop_token& stop);

}  // namespace airtruth::replay
