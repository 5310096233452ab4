// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>

#include "runners/tracking/tracker.h"

namespace airtruth::tracking {

// Makes a tracker that runs in its own process, from "trax:COMMAND" or "trax-socket:COMMAND";
// returns nullptr for any other name.
std::unique_ptr<Tracker> make_trax_tracker(std::string_view name, const TrackerOptions& options);

// Returns the name that the tracker reports, made valid as a file name; "trax" where it reports
// none.
std::string trax_name(std::string_view name, const TrackerOptions& options);

}  // namespace airtruth::tracking
