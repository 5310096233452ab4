// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "camera/lens/lens.h"
#include "foundation/geometry/within_frame.h"
#include "scene/scene/scene.h"

namespace airtruth::sequence {

// The words of an [[intruder]] with an encounter that is in view for most of a clip: of a few
// common ones (head-on, from the left, from the right, overtaken) the one whose reference point is
// in the picture longest. `shake_at` is the camera's measured motion at a time of the clip.
std::string first_encounter(const lens::Lens& lens,
                            const scene::Camera& camera,
                            double duration_s,
                            const std::function<Shake(double time_s)>& shake_at);

}  // namespace airtruth::sequence
