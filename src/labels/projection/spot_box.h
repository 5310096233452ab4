// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/geometry/within_frame.h"
#include "foundation/image/spot.h"

namespace airtruth::projection {

// Bounds of a spot's outline at half of its opacity, from points of it, not clipped by a frame of
// this size. The box holds all that the outline sweeps during the exposure, each row at its own
// time. It looks at no pixel.
Box spot_box(const image::Spot& spot, const Shutter& shutter, int frame_width, int frame_height);

}  // namespace airtruth::projection
