// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "aircraft/mesh.h"

// OpenSceneGraph's loaders as plain triangles. Its types, row vectors and reference counts stay in
// osg_adapter.cpp.
namespace airtruth::aircraft {

// What to do with a part of the model under a chain of named nodes (outermost first).
struct PartChoice {
  bool hidden = false;
  Eigen::Affine3d body_from_file = Eigen::Affine3d::Identity();
  int part = 0;  // index into mesh.parts
};
using ChoosePart = std::function<PartChoice(const std::vector<std::string>& names)>;

// Appends a model file's triangles to `mesh`. For .ac files `folders` are searched for textures
// first. Throws Error for a file that no loader can read or whose texture is missing or unreadable.
void append_model(Mesh& mesh,
                  const std::filesystem::path& file,
                  const std::vector<std::filesystem::path>& folders,
                  const ChoosePart& choose,
                  std::vector<std::filesystem::path>& sources);

}  // namespace airtruth::aircraft
