// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

// Limits on the content of a model file, so that an untrusted file cannot exhaust memory or time. A
// model beyond a limit is an Error.
namespace airtruth::aircraft {

// Each limit is about ten times the largest value in flightgear-data-ai.
constexpr std::size_t kMaxModelBytes = std::size_t{256} << 20;  // the size of one file
constexpr std::size_t kMaxCorners = 6'000'000;                  // over all surfaces of a model
constexpr std::size_t kMaxTriangles = 2'000'000;                // over all surfaces of a model
constexpr double kLargestCoordinate = 1e6;  // in units of the file, or in metres in body axes

}  // namespace airtruth::aircraft
