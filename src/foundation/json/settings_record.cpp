// SPDX-License-Identifier: Apache-2.0
#include "foundation/json/settings_record.h"

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
    for (const auto& [key, value] : settings.items())
      if (there.at(key) != value)
        throw Error(fmt::format("holds results with {} {}; this run has {}: give another --out or "
                                "remove the folder",
                                key,
                                there.at(key).dump(),
                                value.dump()),
                    {file.parent_path().string()});
  } catch (const nlohmann::ordered_json::exception&) {  // a key is missing
    fail_no_record(file);
  }
  return true;
}

}  // namespace airtruth
