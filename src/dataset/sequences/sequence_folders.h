// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

// The finished sequences of a folder: a data set that `dataset build` made, complete or not; the
// output of `dataset import`; or one or more sequences that `render` made.
namespace airtruth::sequences {

// The labels of an imported clip, in its folder; a rendered sequence has none.
inline constexpr const char* kLabels = "labels.jsonl";

struct SequenceFolders {
  fs::path root;
  std::vector<std::string> names;  // sorted; may be empty
  // Of a divided set (layout.h): the numbered folder of each sequence, below root.
  std::map<std::string, std::string> numbered_folder_of;

  // The folder of the sequence with this name.
  fs::path folder(const std::string& name) const;
};

// Throws Error where the path is no folder, and where two numbered folders hold sequences of one
// name.
SequenceFolders sequence_folders(const fs::path& folder);

// The Error for a folder without sequences.
Error no_sequence_in(const fs::path& folder);

}  // namespace airtruth::sequences
