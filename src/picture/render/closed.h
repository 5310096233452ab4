// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "aircraft/model/mesh.h"
#include "picture/render/surfaces.h"

// The closed surfaces of an aircraft: those whose triangles can be given directions of rotation
// such that every side is passed as often one way as the other.
namespace airtruth::render {

// By [part][triangle]: 1 where the triangle's own normal points out of a closed surface, -1 where
// it points into it. 0 where the surface is open, encloses nothing, or has a triangle that is not
// opaque. surfaces: of surfaces_of(). opaque: as Model::Impl::opaque.
std::vector<std::vector<std::int8_t>> outward_normals(
    const aircraft::Mesh& mesh,
    const std::vector<Surfaces>& surfaces,
    const std::vector<std::vector<std::uint8_t>>& opaque);

}  // namespace airtruth::render
