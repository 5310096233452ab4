// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "aircraft/model/load_options.h"

namespace airtruth::aircraft {

// The configuration (gear, flaps, propellers) that an aircraft shows at the airspeed and the height
// of the options, as text. load_aircraft() returns the same aircraft wherever the text and the
// other options are the same. Most aircraft of the list have one configuration for all cruising
// speeds: their gear follows a limit, and their flaps are up above it. The text is empty for a bare
// model file. Of wrappers that are read in a confined process it states the airspeed and the height
// themselves.
std::string configuration_of(const std::string& name, const LoadOptions& options);

}  // namespace airtruth::aircraft
