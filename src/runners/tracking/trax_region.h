// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "foundation/geometry/box.h"

namespace airtruth::tracking {

// Reads the region that a tracker reports: "x,y,w,h"; a polygon "x0,y0,x1,y1,x2,y2,..."; a mask
// "mask:x,y,w,h,n0,n1,..." of run lengths by rows, of which the first run is empty pixels; or one
// number, which means that there is no region. Polygons and masks become their bounding box.
// Returns empty for one number, for numbers that are not finite, and for a region without area.
// Throws process::Failure for any other text.
std::optional<Box> box_of(std::string_view region);

std::string rectangle_of(const Box& box);
std::string polygon_of(const Box& box);  // its corners
std::string mask_of(const Box& box);     // the whole pixels that it covers by half

}  // namespace airtruth::tracking
