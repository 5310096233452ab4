// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aircraft/model/mesh.h"

namespace airtruth::aircraft {

// Removes triangles without area, which have no normal; the second of two triangles in the same
// place with opposite sides, since a translucent surface would be drawn twice; and the vertices and
// parts that are then unused.
void tidy(Mesh& mesh);

}  // namespace airtruth::aircraft
