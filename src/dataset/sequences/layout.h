// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

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

// Whether a folder of `sequences` with this name holds sequences of a divided set: its name
// consists of digits.
bool is_numbered_folder(const std::string& name);

}  // namespace airtruth::sequences
