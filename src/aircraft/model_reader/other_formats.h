// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "aircraft/wrapper/assembly.h"

namespace airtruth::model_reader {

// Appends the triangles of a model file in another format than .ac by the Open Asset Import Library
// (assimp): .obj .3ds .stl .ply .dae .gltf .glb .fbx. Only the importer for the ending of the file
// runs. Files that the model names come from assembly.files(). Coordinates are those of the file;
// PartChoice::body_from_file converts them. Throws Error where the file is unreadable, has no
// triangles or exceeds a limit.
void append_other_format(wrapper::Assembly& assembly, const wrapper::ModelFile& file);

}  // namespace airtruth::model_reader
