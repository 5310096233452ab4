// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "aircraft/wrapper/model_files.h"
#include "aircraft/wrapper/wrapper_text.h"

// A FlightGear wrapper XML of a 3D model, with the wrappers that it includes and nests. It states
// the place of the model, the condition under which each part is visible, and which parts turn.
namespace airtruth::aircraft {

struct Wrapper {
  fs::path file;            // this and the paths below: below the folder of the model's files
  std::string name;         // what the wrapper that nests this one calls it
  fs::path model;           // empty where the wrapper holds nested models alone
  fs::path texture_folder;  // searched before all else; empty: none
  Eigen::Affine3d parent_from_nested = Eigen::Affine3d::Identity();  // where a nested one is put
  Eigen::Affine3d nested_from_model = Eigen::Affine3d::Identity();   // its own <offsets>
  std::vector<Condition> conditions;                                 // all must hold for it to show
  std::vector<Animation> animations;
  std::vector<Wrapper> nested;
};

// Reads a wrapper, what it includes and what it nests. A property of the file itself overrides one
// that it includes. Paths are below the folder of `files`. A nested model that is missing is left
// out, as in FlightGear, and added to `missing`. Lamps, smoke, rain and sounds are left out. Throws
// Error with file and line where a file is no XML or missing, and where includes form a cycle.
Wrapper read_wrapper(ModelFiles& files, const fs::path& file, std::set<std::string>& missing);

// Whether the path is that of a lamp, smoke, rain or a sound.
bool is_effect_path(const std::string& path);

// The file that a path such as "Models/a.ac" or "AI/Aircraft/x/b.xml" means in a wrapper in
// `folder`. It is searched beside the wrapper, below FlightGear's data root, and in that root's AI.
// Returns an empty path where it is in none of them or not below the folder of `files`.
fs::path find_named_file(ModelFiles& files, const std::string& path, const fs::path& folder);

}  // namespace airtruth::aircraft
