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

// By [part][triangle]: 1 where the opacity is the same all over the triangle: it has no texture
// with translucent texels, or the opacities of the texels within it differ by less than 1/100. And
// 1 for an opaque triangle. opaque: of opaque_triangles().
std::vector<std::vector<std::uint8_t>> even_triangles(
    const aircraft::Mesh& mesh, const std::vector<std::vector<std::uint8_t>>& opaque);

}  // namespace airtruth::render
