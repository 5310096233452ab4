// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "picture/render/model.h"

namespace airtruth::render {

// Ambient occlusion of an aircraft by itself, for either side of each triangle, as
// [part][triangle]. Three values are computed: the cosine-weighted share of the directions above
// the triangle in which no part of the aircraft stands (Zhukov et al. 1998); the mean direction of
// the open ones (Landis 2002); and the light that the hiding parts reflect after one bounce, with
// its mean direction. Spinning parts cast no shadow and count as fully open. The result is the same
// for any number of threads.
//
// Shares are computed inside the triangle and not at its vertices: the vertices of a wing's root
// lie within the fuselage, and triangles from there to the tip would be dark over their whole
// length.
using ModelOpenness = std::vector<std::vector<TriangleOpenness>>;
ModelOpenness model_openness(const Model::Impl& model);

}  // namespace airtruth::render
