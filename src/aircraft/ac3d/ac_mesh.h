// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "aircraft/ac3d/ac_file.h"
#include "aircraft/ac3d/batch.h"

namespace airtruth::aircraft {

// The triangles of one object, one batch per material in the order of the materials. Polygons
// become triangles. In a vertex of smooth surfaces, the normals of surfaces that meet at less than
// the crease angle, directly or through others, are averaged with their areas as weights. Other
// surfaces are flat. Both rules are those of OpenSceneGraph's AC3D reader, for which FlightGear's
// models are made.
std::vector<Batch> batches_of(const AcFile& file, const AcObject& object);

}  // namespace airtruth::aircraft
