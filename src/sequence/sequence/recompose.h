// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "sequence/sequence/finished.h"

namespace airtruth::sequence {

// Draws every n-th frame of a finished sequence anew, from its record, its background and the
// motion that its truth states, and compares: the line of truth must come out the same, a lossless
// video sample by sample, a lossy one no further off around the intruder than its codec is
// elsewhere. Each fault is one line. `compared`: frames that were.
struct Recomposition {
  std::int64_t compared = 0;
  std::vector<std::string> faults;
};
Recomposition recompose(const Finished& sequence, std::int64_t every, const std::stop_token& stop);

}  // namespace airtruth::sequence
