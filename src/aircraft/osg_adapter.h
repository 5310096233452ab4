// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "aircraft/mesh.h"

// OpenSceneGraph's loaders as plain triangles. Its types, row vectors and
// reference counts stay in osg_adapter.cpp and osg_image.cpp.
namespace airtruth::aircraft {

// What to do with a part of the model under a chain of named nodes (outermost
// first).
struct PartChoice {
  bool hidden = false;
  Eigen::Affine3d body_from_file = Eigen::Affine3d::Identity();
  int part = 0;                   // index into mesh.parts
  float opacity = 1;              // times the material's own
  std::filesystem::path texture;  // in place of the part's own; empty: its own
};
using ChoosePart = std::function<PartChoice(const std::vector<std::string>& names)>;

// What is being put together: the mesh, and what several model files of one
// aircraft share.
struct Assembly {
  Mesh mesh;
  std::vector<std::filesystem::path> sources;  // every file read
  std::map<std::string, int> texture_of_file;  // index into mesh.textures
};

// Appends a model file's triangles. Textures are looked for in `folders`, in
// their order. Throws Error for a file that no loader can read or whose texture
// is missing or unreadable.
void append_model(Assembly& assembly,
                  const std::filesystem::path& file,
                  const std::vector<std::filesystem::path>& folders,
                  const ChoosePart& choose);

}  // namespace airtruth::aircraft
