// SPDX-License-Identifier: Apache-2.0
#include "foundation/json/settings_record.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/parse_json.h"

namespace airtruth {
namespace {

[[noreturn]] void fail_no_record(const std::filesystem::path& file) {
  throw Error("is not a record that airtruth wrote", {file.string()});
}

nlohmann::ordered_json record_in(const std::filesystem::path& file) {
  auto record = parse_json(read_file(file));
  if (!record.is_object()) fail_no_record(file);
  return record;
}

void expect_same(const std::filesystem::path& place,
                 const std::string& key,
                 const nlohmann::ordered_json& there,
                 const nlohmann::ordered_json& mine) {
  if (there != mine)
    throw Error(fmt::format("holds results with {} {}; this run has {}: give another --out or "
                            "remove the folder",
                            key,
                            there.dump(),
                            mine.dump()),
                {place.string()});
}

// Beside the record: of runs that were all broken off there are logs alone.
bool is_without_results(const std::filesystem::path& file) {
  return std::ranges::all_of(entries(file.parent_path()), [&](const std::filesystem::path& entry) {
    return entry == file || entry.filename() == "logs";
  });
}

}  // namespace

void check_record(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) record_in(file);
}

bool is_record_of(const std::filesystem::path& file, const nlohmann::ordered_json& settings) {
  if (!std::filesystem::exists(file)) {
    refuse_foreign(file.parent_path(), {file.filename().c_str()});
    return false;
  }
  try {
    const auto there = record_in(file);
    for (const auto& [key, value] : settings.items()) {
      if (there.at(key) != value && is_without_results(file)) return false;
      expect_same(file.parent_path(), key, there.at(key), value);
    }
  } catch (const nlohmann::ordered_json::exception&) {  // a key is missing
    fail_no_record(file);
  }
  return true;
}

void refuse_other(const std::filesystem::path& file, const nlohmann::ordered_json& settings) {
  if (settings.empty() || !std::filesystem::exists(file)) return;
  const auto there = record_in(file);
  for (const auto& [key, value] : settings.items())
    if (there.contains(key)) expect_same(file, key, there.at(key), value);
}

}  // namespace airtruth
