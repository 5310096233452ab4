// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "foundation/geometry/box.h"

namespace airtruth::trax {

// Where a tracker says that its object is: "x,y,w,h"; a polygon "x0,y0,x1,y1,x2,y2,..."; a mask
// "mask:x,y,w,h,n0,n1,..." of run lengths by rows, the first run empty; or one number, which says
// that there is nothing to say. Polygons and masks become the box that bounds them. Empty for one
// number, and where a number is not finite or the region has no area. Throws ProtocolError for what
// is no region.
std::optional<Box> box_of(std::string_view region);

std::string rectangle_of(const Box& box);
std::string polygon_of(const Box& box);  // its corners
std::string mask_of(const Box& box);     // the whole pixels that it covers by half

}  // namespace airtruth::trax
