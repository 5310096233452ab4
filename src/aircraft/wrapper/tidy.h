// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aircraft/model/mesh.h"

namespace airtruth::aircraft {

// Drops triangles without area (they have no normal), triangles drawn twice in
// the same place from either side (they would shine through one another where
// translucent), and the vertices and parts that this leaves unused.
void tidy(Mesh& mesh);

}  // namespace airtruth::aircraft
