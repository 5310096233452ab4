// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "runners/tracking/tracker.h"

namespace airtruth::tracking {

// Makes one of OpenCV's trackers that need no model file; returns nullptr for any other name. Each
// tracker gets newly seeded random numbers.
std::unique_ptr<Tracker> make_opencv_tracker(std::string_view name, std::uint64_t seed);

}  // namespace airtruth::tracking
