// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "foundation/disk_cache/disk_cache.h"
#include "picture/shade/model_impl.h"

namespace airtruth::shade {

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
using ModelOcclusion = std::vector<std::vector<TriangleOcclusion>>;
ModelOcclusion model_occlusion(const Model::Impl& model);

// What the ambient occlusion depends on: the positions, the triangles of each part and whether the
// part moves, and `tracer`: the version and the instruction set of Embree. The liveries of one
// model share it.
disk_cache::Key occlusion_key(const model::Mesh& mesh, std::string_view tracer);

// As an entry of the cache holds it, and back. Error where the entry is of another mesh or out of
// range.
std::string stored(const ModelOcclusion& occlusion);
ModelOcclusion occlusion_from(const std::string& body, const model::Mesh& mesh);

}  // namespace airtruth::shade
