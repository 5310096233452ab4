// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace airtruth::aircraft {

// An AC3D file's text made ready for OpenSceneGraph's loader: crease angles above 60 degrees become
// 60 (179, as many models have, smooths over wing edges and leaves normals that oppose their face),
// and texture names become the full path of the file found in `folders` (in order), whose paths are
// added to `sources`. Error where a texture is missing.
std::string prepared_ac(const std::filesystem::path& file,
                        const std::vector<std::filesystem::path>& folders,
                        std::vector<std::filesystem::path>& sources);

// The file of that name, or of its bare file name, in the first folder that holds it; empty path:
// nowhere.
std::filesystem::path find_texture(const std::string& name,
                                   const std::vector<std::filesystem::path>& folders);

}  // namespace airtruth::aircraft
