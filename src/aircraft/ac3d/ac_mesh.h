// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "aircraft/ac3d/ac_file.h"
#include "aircraft/ac3d/batch.h"

namespace airtruth::aircraft {

// The triangles of one object, a batch for each material that it uses, in the materials' order.
// Polygons become triangles; the normals of smooth surfaces that meet in a vertex at less than the
// crease angle, directly or by way of others, are averaged, weighted by area; other surfaces are
// flat. Both follow OpenSceneGraph's AC3D reader, which FlightGear's models are drawn for.
std::vector<Batch> batches_of(const AcFile& file, const AcObject& object);

}  // namespace airtruth::aircraft
