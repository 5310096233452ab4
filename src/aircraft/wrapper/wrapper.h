// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include "aircraft/wrapper/model_files.h"
#include "aircraft/wrapper/wrapper_text.h"

namespace airtruth::wrapper {

// Reads a FlightGear wrapper XML of a 3D model, what it includes and what it nests. A property of
// the file itself overrides one that it includes. Paths are below the folder of `files`. A nested
// model that is missing is left out, as in FlightGear, and added to `missing`. Lamps, smoke, rain
// and sounds are left out. Throws Error with file and line where a file is no XML or missing, and
// where includes form a cycle.
Wrapper read_wrapper(ModelFiles& files,
                     const fs::path& file,
                     const Cruise& cruise,
                     std::set<std::string>& missing);

// The file that a path such as "Models/a.ac" or "AI/Aircraft/x/b.xml" means in a wrapper in
// `folder`. It is searched beside the wrapper, below FlightGear's data root, and in that root's AI.
// Returns an empty path where it is in none of them or not below the folder of `files`.
fs::path find_named_file(ModelFiles& files, const std::string& path, const fs::path& folder);

}  // namespace airtruth::wrapper
