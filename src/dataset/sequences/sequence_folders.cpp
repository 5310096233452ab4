// SPDX-License-Identifier: Apache-2.0
#include "dataset/sequences/sequence_folders.h"

#include <algorithm>

#include "dataset/sequences/layout.h"

namespace airtruth::sequences {
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

SequenceFolders divided_set_in(const fs::path& root) {
  SequenceFolders result{root, {}, {}};
  for (const auto& entry : fs::directory_iterator(root)) {
    const std::string numbered = entry.path().filename().string();
    if (!entry.is_directory() || !is_numbered_folder(numbered)) continue;
    for (const std::string& name : sequences_in(entry.path())) {
      const auto [other, is_new] = result.numbered_folder_of.emplace(name, numbered);
      if (!is_new)
        throw Error("holds a sequence '" + name + "' in both " + std::min(other->second, numbered) +
                        " and " + std::max(other->second, numbered) +
                        "; expected a name to be there once",
                    {root.string()});
    }
  }
  for (const auto& [name, numbered] : result.numbered_folder_of) result.names.push_back(name);
  return result;
}

}  // namespace

fs::path SequenceFolders::folder(const std::string& name) const {
  const auto numbered = numbered_folder_of.find(name);
  return numbered == numbered_folder_of.end() ? root / name : root / numbered->second / name;
}

SequenceFolders sequence_folders(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw Error("is no folder", {folder.string()});
  if (is_sequence(folder)) {
    fs::path own = fs::absolute(folder).lexically_normal();
    if (!own.has_filename()) own = own.parent_path();
    return {own.parent_path(), {own.filename().string()}, {}};
  }
  const fs::path sequences = folder / "sequences";
  const fs::path root = fs::is_directory(sequences) ? sequences : folder;
  if (read_layout(root).is_divided()) return divided_set_in(root);
  return {root, sequences_in(root), {}};
}

Error no_sequence_in(const fs::path& folder) {
  return Error(
      "holds no finished sequence; expected what `airtruth dataset build`, `dataset import` "
      "or `render` has made",
      {folder.string()});
}

}  // namespace airtruth::sequences
