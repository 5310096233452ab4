// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "picture/render/openness.h"

// A cache of openness on the disk. An entry is named by the SHA-256 of all that the openness
// depends on: the positions, the triangles of each part and whether the part spins, the method's
// version, and Embree's version and instruction set. The liveries of one model share an entry.
//
// An entry begins with the SHA-256 of its body. One that is damaged, of another length or out of
// range counts as missing.
namespace airtruth::render {

struct OpennessCache {
  // Empty: nothing is kept.
  std::filesystem::path folder;
  // Of the entry.
  std::string name;
};

// `tracer`: the version and the instruction set of Embree.
OpennessCache openness_cache(const std::filesystem::path& folder,
                             const aircraft::Mesh& mesh,
                             std::string_view tracer);

// The openness of the entry, as [part][triangle] of the mesh; empty where there is no sound entry.
std::optional<ModelOpenness> cached_openness(const OpennessCache& cache,
                                             const aircraft::Mesh& mesh);

// Writes an entry. A cache that cannot be written is no error: the openness is computed again the
// next time.
void keep_openness(const OpennessCache& cache, const ModelOpenness& openness);

}  // namespace airtruth::render
