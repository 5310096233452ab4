// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <airtruth/statistics.h>
#include <nlohmann/json.hpp>

#include "foundation/base/log.h"
#include "foundation/json/or_null.h"

// What the tables of trackers and of detectors have in common: values of JSON, tables of CSV whose
// cells are such values, and the files.
namespace airtruth::report {

using Json = nlohmann::ordered_json;

// The list of what `of` makes of each.
Json list_of(const auto& all, const auto& of) {
  Json list = Json::array();
  for (const auto& one : all) list.push_back(of(one));
  return list;
}

// [low, high], or null.
Json json_of(const std::optional<evaluation::Interval>& interval);

// A table as RFC 4180 has it, whose cells are values of its rows: what a row does not have, null
// and a number that is not finite are empty. `columns` are their headings, each with the place of
// its value where that is not the heading, as RFC 6901 writes it but for the first slash: "a" or
// "a=b/c". A * stands for two columns, the ends "low" and "high" of the interval at the place.
// `number` is the format of numbers with a fraction: "{}" for all their digits.
//
// Example: "name,p=share/value,p_*=share/interval" is name,p,p_low,p_high, and the row {"name":
// "a", "share": {"value": 0.5, "interval": [0.25, 0.75]}} is a,0.5,0.25,0.75.
std::string csv_of(std::string_view columns, const std::vector<Json>& rows, const char* number);
// The same without the headings.
std::string csv_rows(std::string_view columns, const std::vector<Json>& rows, const char* number);

// The name of a tracker or detector is that of its folder of results or, without the ending, of its
// file. Throws Error for one that is not UTF-8.
std::string name_of_results(const std::filesystem::path& results);

// Warns, where there are any, of the sequences whose results `airtruth COMMAND` made of other
// content than the set holds.
void warn_of_other_content(const std::filesystem::path& results,
                           const std::vector<std::string>& sequences,
                           const char* command,
                           const Warn& warn);

// Files by name with their text, in order, into a folder that is made where it is not there. Throws
// Error where that fails.
using Files = std::vector<std::pair<std::string, std::string>>;
void write_files(const std::filesystem::path& out, const Files& files);

}  // namespace airtruth::report
