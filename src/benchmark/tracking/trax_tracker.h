// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "benchmark/tracking/tracker.h"

namespace airtruth::tracking {

// A tracker in a process of its own, from "trax:COMMAND" or "trax-socket:COMMAND"; nullptr for
// another name.
std::unique_ptr<Tracker> make_trax_tracker(std::string_view name, const TrackerOptions& options);

// The name that the tracker gives itself, fit for a file; "trax" where it gives none.
std::string trax_name(std::string_view name, const TrackerOptions& options);

}  // namespace airtruth::tracking
