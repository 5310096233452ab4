// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "runners/results/detections.h"

namespace airtruth::results {

// What makes a detection impossible in a picture of this size (0: unknown), as the first half of a
// message; empty where it is possible. A box must have an area and touch the picture; its numbers
// and the score must be finite.
//
//   fault_of({{700, 0, 9, 9}, 1}, 640, 480) == "the box 700,0 9x9 lies outside its image of
//   640x480"
std::optional<std::string> fault_of(const Detection& detection, int width, int height);

}  // namespace airtruth::results
