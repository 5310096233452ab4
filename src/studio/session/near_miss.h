// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "studio/document/document.h"
#include "studio/messages/request.h"
#include "studio/session/stage.h"

namespace airtruth::session {

// [intruder.encounter] of the intruder that goes through its place in a frame, with the middle of
// its exact box at the same pixel, and then past the own aircraft
// (encounter/placement/by_approach.h). Numbers have the digits that move the box by less than a
// tenth of a pixel. Throws Error where there is no such intruder or path, or the clip's motion is
// not known yet.
nlohmann::ordered_json encounter_through(const Stage& stage,
                                         const document::Tables& tables,
                                         const messages::NearMiss& wanted);

}  // namespace airtruth::session
