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

bool is_numbered_folder(const std::string& name) {
  return !name.empty() &&
         std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace airtruth::sequences
