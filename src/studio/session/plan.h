// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "studio/document/document.h"
#include "studio/session/stage.h"

namespace airtruth::session {

// ["intruder", 0] of what begins there; null where no table begins there.
nlohmann::ordered_json table_at(const document::Tables& tables, const Where& where);

// The paths of all that flies, as the page draws them: docs/how-to/studio.md has the members. Of a
// flock the path of its middle stands for all, and the closest approach is that of its middle.
nlohmann::ordered_json plan_of(Stage& stage, const document::Tables& tables);

// The exact boxes in one frame, of each that is in view: {"table", "id", "box", "range_m"}.
nlohmann::ordered_json boxes_of(const Stage& stage,
                                const setup::Moment& moment,
                                const document::Tables& tables);

// The paths over one frame: where each of them would be seen at other times, had the camera its
// attitude of that frame. Without the camera's turns and shake between the frames they are the
// lines that fly. {"table", "points": [[frame, x, y]]}, without a place where the lens has none.
nlohmann::ordered_json lines_over(const Stage& stage,
                                  std::int64_t frame,
                                  const document::Tables& tables);

// Where fixed directions of the world are seen in a frame: [[azimuth_deg, elevation_deg, x, y]], at
// whole multiples of a step that follows from the field of view. Where the measured motion is
// right, they stay on the clouds and on what is far away from frame to frame.
nlohmann::ordered_json directions_over(const Stage& stage, std::int64_t frame);

}  // namespace airtruth::session
