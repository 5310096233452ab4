// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "aircraft/wrapper/model_files.h"
#include "aircraft/wrapper/wrapper_text.h"

// FlightGear's wrapper XML of a 3D model with what it includes and nests: where
// the model lies, which parts show when, what turns.
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

// Reads a wrapper with what it includes and all that it nests; what a file says itself comes after,
// and over, what it includes. Paths are below the folder of `files`. A nested model that is missing
// is left out (FlightGear does so), and named in `missing`. Lamps, smoke, rain and sounds are left
// out. Errors carry file and line: not XML, a missing file, includes that go round.
Wrapper read_wrapper(ModelFiles& files, const fs::path& file, std::set<std::string>& missing);

// A lamp, smoke, rain, a sound: by its path.
bool is_effect_path(const std::string& path);

// The file that "Models/a.ac" or "AI/Aircraft/x/b.xml" means in a wrapper in `folder`: beside it,
// below FlightGear's data root, or in that root's AI. Empty path: nowhere below the folder of
// `files`.
fs::path find_named_file(ModelFiles& files, const std::string& path, const fs::path& folder);

}  // namespace airtruth::aircraft
