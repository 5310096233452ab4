// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "picture/render/ray_triangles.h"
#include "picture/render/shade_pixel.h"

// The reference of the tests, and what lies outside the frame: a ray of its own (Embree) for each
// sample, through the lens and the poses of the sample's time. It shares no code with the edge
// functions.
namespace airtruth::render {

// What rays through a pixel meet.
RenderedPixel trace_pixel(const View& view,
                          const shade::Light& light,
                          const std::vector<PlacedInstance>& instances,
                          int x,
                          int y);

// The area in pixels that an instance covers outside the frame, within its search box.
double area_outside(const View& view, const PlacedInstance& placed, const Box& search);

}  // namespace airtruth::render
