// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "aircraft/wrapper/assembly.h"

namespace airtruth::model_reader {

// Appends the triangles of a model that is no .ac, by Open Asset Import Library (assimp): .obj .3ds
// .stl .ply .dae .gltf .glb .fbx. Only the importer of the file's own ending is asked, and files
// that a model names come from the assembly's files. Coordinates are the file's own. Throws Error.
void append_other_format(aircraft::Assembly& assembly,
                         const std::filesystem::path& file,
                         const std::vector<std::filesystem::path>& folders,
                         const aircraft::ChoosePart& choose);

}  // namespace airtruth::model_reader
