// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "foundation/image/spot.h"
#include "labels/projection/exact_box.h"
#include "scene/scene/distractor.h"

namespace airtruth::setup {

// The spot that a mark on the lens draws at a time of the clip; empty before its beginning and
// after its end. A glint that follows the sun has its place in each frame from the sun's pixel; it
// is empty where the sun is behind the camera or beyond the lens's field. `seed` is that of the
// scene: with the mark's id it gives dirt its shape.
std::optional<image::Spot> spot_of(const scene::LensMark& mark,
                                   const projection::Sight& sight,
                                   const Vector3& to_sun_in_world,
                                   double time_s,
                                   std::uint64_t seed);

// True from the mark's beginning to its end.
bool is_there(const scene::LensMark& mark, double time_s);

}  // namespace airtruth::setup
