// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace airtruth::aircraft {

// An AC3D file made ready for OpenSceneGraph's loader: crease angles above 60
// degrees become 60 (179, as many models have, smooths over wing edges and
// leaves normals that oppose their face).
struct PreparedAc {
  std::string text;
  std::map<std::string, int> line_of_texture;  // where a texture is first named
};
PreparedAc prepared_ac(const std::filesystem::path& file);

// The file of that name, or of its bare file name, in the first folder that
// holds it; empty path: nowhere.
std::filesystem::path find_texture(const std::string& name,
                                   const std::vector<std::filesystem::path>& folders);

// "a, b, c".
std::string listed(const std::vector<std::filesystem::path>& folders);

}  // namespace airtruth::aircraft
