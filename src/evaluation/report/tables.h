// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <airtruth/statistics.h>
#include <nlohmann/json.hpp>

// What the tables of trackers and of detectors have in common: cells of CSV, values of JSON, and
// the files.
namespace airtruth::report {

using Json = nlohmann::ordered_json;

// A name as a cell of RFC 4180: in quotes where it holds a comma, a quote or a line break.
std::string quoted(const std::string& text);

// The value, or null where there is none.
template <typename T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}
// [low, high], or null.
Json json_of(const std::optional<evaluation::Interval>& interval);
// The upper end of a bin; null for the last one, which has none.
Json json_of_bound(double bound);

// The name of a tracker or detector is that of its folder of results or, without the ending, of its
// file. Throws Error for one that is not UTF-8.
std::string name_of_results(const std::filesystem::path& results);

// Files by name with their text, in order, into a folder that is made where it is not there. Throws
// Error where that fails.
using Files = std::vector<std::pair<std::string, std::string>>;
void write_files(const std::filesystem::path& out, const Files& files);

}  // namespace airtruth::report
