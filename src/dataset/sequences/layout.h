// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

// The place of each sequence below a data set's folder `sequences`. A small set has its sequences
// in that folder itself (sequences/NAME). A larger set has them in numbered folders
// (sequences/0001/NAME) that hold equally many, so that no folder becomes slow to list, to copy or
// to look through.
//
// Example: with 4,000 sequences in a folder, number 0 of 10,000 lies in sequences/0001, number
// 4,000 in sequences/0002 and number 9,999 in sequences/0003. All of 3,000 lie in sequences.
namespace airtruth::sequences {

// A set with more sequences is divided. Below this number a listing with the files' sizes takes
// some tens of milliseconds on a local disk and under a second on a network file system of 0.2 ms
// per request, and file managers open the folder at once (docs/scaling.md).
constexpr std::int64_t kMaxSequencesInAFolder = 4000;

struct Layout {
  std::int64_t sequences_in_a_folder = 0;  // 0: all sequences lie in one folder

  bool is_divided() const { return sequences_in_a_folder > 0; }
  // The folder of a sequence, relative to `sequences`: "0001", "0002", ...; empty where the set is
  // not divided. `index` counts from 0.
  fs::path folder_of(std::int64_t index) const;
};

// The layout of a new set.
Layout layout_for(std::int64_t sequences, std::int64_t max_in_a_folder = kMaxSequencesInAFolder);

// A divided set records its layout in sequences/layout.json, so that it is continued and read in
// the layout in which it was begun. Throws Error where the file is broken.
Layout read_layout(const fs::path& sequences);

// Writes the file, or removes it where the set is not divided.
void write_layout(const fs::path& sequences, const Layout& layout);

// The labels of an imported clip, in its folder; a rendered sequence has none.
inline constexpr const char* kLabels = "labels.jsonl";
// The list of an imported clip's pictures, beside its labels; one of a video has none.
inline constexpr const char* kPictureList = "pictures.txt";

// The finished sequences of a folder: a data set that `dataset build` made, complete or not; the
// output of `dataset import`; or one or more sequences that `render` made.
struct SequenceFolders {
  fs::path root;
  std::vector<std::string> names;  // sorted; may be empty
  // Of a divided set: the numbered folder of each sequence, below root.
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
