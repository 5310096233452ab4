// SPDX-License-Identifier: Apache-2.0
#include "evaluation/report/tables.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/files.h"
#include "foundation/base/text.h"

namespace airtruth::report {
namespace {

struct Column {
  std::string name;
  Json::json_pointer place;
};

std::vector<Column> columns_of(std::string_view text) {
  std::vector<Column> columns;
  for (const std::string& cell : cells_of(text)) {
    const std::size_t equals = std::min(cell.find('='), cell.size());
    const std::string name = cell.substr(0, equals);
    const std::string place = "/" + (equals < cell.size() ? cell.substr(equals + 1) : name);
    const std::size_t star = name.find('*');
    if (star == std::string::npos) {
      columns.push_back({name, Json::json_pointer(place)});
      continue;
    }
    for (const auto& [end, number] : {std::pair{"low", "/0"}, {"high", "/1"}})
      columns.push_back(
          {std::string(name).replace(star, 1, end), Json::json_pointer(place + number)});
  }
  return columns;
}

std::string cell_of(const Json& value, const char* number) {
  if (value.is_string()) return csv_cell(value.get<std::string>());
  if (value.is_null()) return "";
  if (!value.is_number_float()) return value.dump();
  const auto fraction = value.get<double>();
  return std::isfinite(fraction) ? fmt::format(fmt::runtime(number), fraction) : "";
}

}  // namespace

Json json_of(const std::optional<evaluation::Interval>& interval) {
  return interval ? Json{interval->low, interval->high} : Json();
}

std::string csv_of(std::string_view columns, const std::vector<Json>& rows, const char* number) {
  std::string text;
  for (const Column& column : columns_of(columns)) text += (text.empty() ? "" : ",") + column.name;
  return text + "\n" + csv_rows(columns, rows, number);
}

std::string csv_rows(std::string_view columns, const std::vector<Json>& rows, const char* number) {
  const std::vector<Column> known = columns_of(columns);
  std::string text;
  for (const Json& row : rows) {
    for (std::size_t i = 0; i < known.size(); ++i) {
      if (i > 0) text += ",";
      if (row.contains(known[i].place)) text += cell_of(row.at(known[i].place), number);
    }
    text += "\n";
  }
  return text;
}

std::string name_of_results(const fs::path& results) {
  const fs::path plain = absolute_path(results);
  require_utf8(plain);
  if (fs::is_regular_file(plain)) return plain.stem().string();
  return plain.filename().string();
}

void warn_of_other_content(const fs::path& results,
                           const std::vector<std::string>& sequences,
                           const char* command,
                           const Warn& warn) {
  if (sequences.empty()) return;
  airtruth::warn(
      warn,
      fmt::format(
          "{}: the results of {} sequences were made of other content than the set has, which was "
          "made or labelled anew since (the first: {}); `airtruth {}` with another --out makes new "
          "ones",
          results.string(),
          sequences.size(),
          sequences.front(),
          command));
}

void write_files(const fs::path& out, const Files& files) {
  make_folders(out);
  for (const auto& [name, text] : files) write_file(out / name, text);
}

}  // namespace airtruth::report
