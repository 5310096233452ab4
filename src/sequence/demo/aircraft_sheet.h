// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aircraft/fleet/fleet.h"
#include "foundation/image/picture.h"

namespace airtruth::demo {

// Returns a contact sheet of one aircraft as the renderer sees it: nose, tail, both sides, above,
// below, two oblique views, and its appearance at 40 and 10 pixels, each with its name.
image::Rgb8 aircraft_sheet(const fleet::Aircraft& aircraft);

// One view, from the front left and above, 150 px square: a tile of a sheet of many aircraft.
image::Rgb8 aircraft_tile(const fleet::Aircraft& aircraft);

}  // namespace airtruth::demo
