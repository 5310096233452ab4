// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "benchmark/tracking/tracker.h"

namespace airtruth::tracking {

// OpenCV's own trackers that need no model file; nullptr for another name. Their random numbers are
// seeded anew for each tracker.
std::unique_ptr<Tracker> make_opencv_tracker(std::string_view name, std::uint64_t seed);

}  // namespace airtruth::tracking
