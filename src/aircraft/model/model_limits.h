// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

// Limits on what a model file may hold, so that a file from a stranger exhausts neither memory nor
// time. Each is about ten times what the largest aircraft of flightgear-data-ai holds.
namespace airtruth::aircraft {

constexpr std::size_t kMaxModelBytes = std::size_t{256} << 20;  // of one file
constexpr std::size_t kMaxCorners = 6'000'000;                  // of all surfaces together
constexpr std::size_t kMaxTriangles = 2'000'000;                // of all surfaces together
constexpr double kLargestCoordinate = 1e6;                      // units of the file, or body metres

}  // namespace airtruth::aircraft
