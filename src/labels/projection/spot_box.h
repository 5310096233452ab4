// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/geometry/within_frame.h"
#include "foundation/image/spot.h"

namespace airtruth::projection {

// Bounds of a spot's outline at half of its opacity, not clipped by a frame of this size: in closed
// form for a capsule, from points of the outline for a circle with lobes. It holds all that the
// outline sweeps during the exposure of the row of the spot's middle. It looks at no pixel.
Box spot_box(const image::Spot& spot, const Shutter& shutter, int frame_width, int frame_height);

}  // namespace airtruth::projection
