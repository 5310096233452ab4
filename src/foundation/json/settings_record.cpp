// SPDX-License-Identifier: Apache-2.0
#include "foundation/json/settings_record.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth {

bool is_record_of(const std::filesystem::path& file, const nlohmann::ordered_json& settings) {
  if (!std::filesystem::exists(file)) return false;
  try {
    const auto there = nlohmann::ordered_json::parse(read_file(file));
    for (const auto& [key, value] : settings.items())
      if (there.at(key) != value)
        throw Error(fmt::format("holds results with {} {}; this run has {}: give another --out or "
                                "remove the folder",
                                key,
                                there.at(key).dump(),
                                value.dump()),
                    {file.parent_path().string()});
  } catch (const nlohmann::ordered_json::exception&) {
    throw Error("is not a record that airtruth wrote", {file.string()});
  }
  return true;
}

}  // namespace airtruth
