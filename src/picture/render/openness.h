// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "picture/render/model.h"

namespace airtruth::render {

// How much of the light from all around the aircraft leaves to each of its triangles: the share, by
// cosine, of the directions above it in which nothing of the aircraft stands (ambient occlusion:
// Zhukov et al. 1998), and about which direction they lie (Landis 2002); and how much of the light
// from about which direction what stands there gives back, once. For either side of each triangle,
// as [part][triangle]; what spins shadows nothing and is open itself. The same numbers for any
// number of threads.
//
// Shares are taken inside the triangle and not at its vertices: those of a wing's root lie within
// the fuselage, and triangles that reach from there to the tip would be dark all along.
using ModelOpenness = std::vector<std::vector<TriangleOpenness>>;
ModelOpenness model_openness(const Model::Impl& model);

}  // namespace airtruth::render
