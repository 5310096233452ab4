// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "aircraft/model/mesh.h"

namespace airtruth::render {

// By [part][triangle]: 1 where the triangle hides all behind it: its material is opaque, and so is
// every texel whose middle lies within it, or where none does, the texel in its middle. A livery's
// texture has transparent texels in regions that other triangles use as cut-outs, and between its
// painted regions; a look-up at a triangle's side may mix in some of those, which are not meant.
std::vector<std::vector<std::uint8_t>> opaque_triangles(const aircraft::Mesh& mesh);

}  // namespace airtruth::render
