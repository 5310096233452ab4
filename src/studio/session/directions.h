// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

#include "studio/session/stage.h"

namespace airtruth::session {

// Where fixed directions of the world are seen in a frame: [[azimuth_deg, elevation_deg, x, y]], at
// whole multiples of a step that follows from the field of view. Where the measured motion is
// right, they stay on the clouds and on what is far away from frame to frame.
nlohmann::ordered_json directions_over(const Stage& stage, std::int64_t frame);

}  // namespace airtruth::session
