// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "aircraft/wrapper_text.h"

// FlightGear's wrapper XML of a 3D model with what it includes and nests: where
// the model lies, which parts show when, what turns.
namespace airtruth::aircraft {

struct Wrapper {
  fs::path file;
  std::string name;         // what the wrapper that nests this one calls it
  fs::path model;           // empty where the wrapper holds nested models alone
  fs::path texture_folder;  // searched before all else; empty: none
  Eigen::Affine3d parent_from_nested = Eigen::Affine3d::Identity();  // where a nested one is put
  Eigen::Affine3d nested_from_model = Eigen::Affine3d::Identity();   // its own <offsets>
  std::vector<Condition> conditions;                                 // all must hold for it to show
  std::vector<Animation> animations;
  std::vector<Wrapper> nested;
};

// The file with its includes: what it says itself comes after, and over, what
// they say. `sources`: every file read. Errors carry file and line: not XML, a
// missing file, includes that go round.
WrapperText read_with_includes(const fs::path& file, std::vector<fs::path>& sources);

// Reads a wrapper and all that it nests. A nested model that is missing is left
// out (FlightGear does so), and named in `missing`. Lamps, smoke, rain and
// sounds are left out.
Wrapper read_wrapper(const fs::path& file,
                     std::vector<fs::path>& sources,
                     std::set<std::string>& missing);

// A lamp, smoke, rain, a sound: by its path.
bool is_effect_path(const std::string& path);

// The file that "Models/a.ac" or "AI/Aircraft/x/b.xml" means in a wrapper in
// `folder`: beside it, in the folder above it that holds AI/Aircraft, or in
// that folder's AI. Empty path: nowhere.
fs::path find_named_file(const std::string& path, const fs::path& folder);

}  // namespace airtruth::aircraft
