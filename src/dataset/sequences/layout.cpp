// SPDX-License-Identifier: Apache-2.0
#include "dataset/sequences/layout.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/json_object.h"

namespace airtruth::sequences {
namespace {

constexpr const char* kFormat = "airtruth layout 1";

fs::path file_in(const fs::path& sequences) { return sequences / "layout.json"; }

}  // namespace

fs::path Layout::folder_of(std::int64_t index) const {
  check(index >= 0, "a sequence's number is not negative");
  if (!is_divided()) return {};
  return fmt::format("{:04}", index / sequences_in_a_folder + 1);
}

Layout layout_for(std::int64_t sequences, std::int64_t max_in_a_folder) {
  check(max_in_a_folder > 0, "a folder holds at least one sequence");
  return {sequences > max_in_a_folder ? max_in_a_folder : 0};
}

Layout read_layout(const fs::path& sequences) {
  const fs::path file = file_in(sequences);
  if (!fs::exists(file)) return {};
  const JsonDocument record(file);
  if (record.text("format") != kFormat)
    throw Error(std::string("is not a layout of airtruth; expected format \"") + kFormat + "\"",
                {file.string()});
  return {record.whole("sequences_in_a_folder", 1)};
}

void write_layout(const fs::path& sequences, const Layout& layout) {
  if (!layout.is_divided()) {
    fs::remove(file_in(sequences));
    return;
  }
  const nlohmann::ordered_json record = {{"format", kFormat},
                                         {"sequences_in_a_folder", layout.sequences_in_a_folder}};
  write_file(file_in(sequences), record.dump(2) + "\n");
}

namespace {

bool is_sequence(const fs::path& folder) { return fs::exists(folder / "sequence.json"); }

std::vector<std::string> sequences_in(const fs::path& folder) {
  std::vector<std::string> names;
  // Hidden folders belong to runs that are under way or were killed.
  for (const fs::path& entry : entries(folder))
    if (is_sequence(entry)) names.push_back(entry.filename().string());
  return names;
}

SequenceFolders divided_set_in(const fs::path& root) {
  SequenceFolders result{root, {}, {}};
  for (const fs::path& folder : entries(root)) {
    const std::string numbered = folder.filename().string();
    if (numbered.find_first_not_of("0123456789") != std::string::npos) continue;
    for (const std::string& name : sequences_in(folder)) {
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
    const fs::path own = absolute_path(folder);
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
