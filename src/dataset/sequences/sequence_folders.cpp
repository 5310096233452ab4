// SPDX-License-Identifier: Apache-2.0
#include "dataset/sequences/sequence_folders.h"

#include <algorithm>

namespace airtruth::dataset {
namespace {

bool is_sequence(const fs::path& folder) { return fs::exists(folder / "sequence.json"); }

std::vector<std::string> sequences_in(const fs::path& folder) {
  std::vector<std::string> names;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      // Hidden folders belong to runs that are under way or were killed.
      if (entry.is_directory() && !entry.path().filename().string().starts_with(".") &&
          is_sequence(entry.path()))
        names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

SequenceFolders sequence_folders(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw Error("is no folder", {folder.string()});
  if (is_sequence(folder)) {
    fs::path own = fs::absolute(folder).lexically_normal();
    if (!own.has_filename()) own = own.parent_path();
    return {own.parent_path(), {own.filename().string()}};
  }
  const fs::path sequences = folder / "sequences";
  const fs::path root = fs::is_directory(sequences) ? sequences : folder;
  return {root, sequences_in(root)};
}

Error no_sequence_in(const fs::path& folder) {
  return Error(
      "holds no finished sequence; expected what `airtruth dataset build`, `dataset import` "
      "or `render` has made",
      {folder.string()});
}

}  // namespace airtruth::dataset
