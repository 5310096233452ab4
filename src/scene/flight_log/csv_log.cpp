// SPDX-License-Identifier: Apache-2.0
// airtruth's own flight log: CSV with a header, one record a row.
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "scene/flight_log/formats.h"

namespace airtruth::flight_log {
namespace {

enum Column {
  kTime,
  kLatitude,
  kLongitude,
  kAltitude,
  kHeight,
  kYaw,
  kPitch,
  kRoll,
  kRateX,
  kRateY,
  kRateZ,
  kColumns
};
const std::vector<std::string> kNames = words_in(
    "time_s latitude_deg longitude_deg altitude_m height_m yaw_deg pitch_deg roll_deg "
    "rate_x_radps rate_y_radps rate_z_radps");
using Places = std::vector<std::size_t>;

// Where each known column stands, and how many columns there are.
struct Header {
  Places places;
  std::size_t columns = 0;
};

std::string_view line_at_start(std::string_view text) { return text.substr(0, text.find('\n')); }

Header columns_of(std::string_view header, const std::string& file) {
  const auto cells = cells_of(header);
  const Places places = places_of(kNames, cells, {file, 1});
  const auto require_together = [&](std::vector<Column> columns) {
    for (const Column column : columns)
      if (places[column] == kNoColumn)
        throw Error(fmt::format("has no column {}", kNames[column]), {file, 1});
  };
  require_together({kTime, kLatitude, kLongitude, kAltitude});
  for (const std::vector<Column>& group :
       {std::vector{kYaw, kPitch, kRoll}, std::vector{kRateX, kRateY, kRateZ}})
    if (std::ranges::any_of(group, [&](Column c) { return places[c] != kNoColumn; }))
      require_together(group);
  return {places, cells.size()};
}

// What a file of our own format states is right, or an error.
template <typename Record>
void add_good(FlightLog& log, const Record& record, const Where& where) {
  if (const std::string fault = fault_of(record); !fault.empty()) throw Error(fault, where);
  add_record(log, record, where);
}

void add_row(FlightLog& log, const Header& header, std::string_view line, const Where& where) {
  const Places& places = header.places;
  const auto cells = cells_of(line);
  if (cells.size() > header.columns)
    throw Error(
        fmt::format("has {} cells for {} columns; expected one each", cells.size(), header.columns),
        where);
  const auto number = [&](Column column) {
    if (places[column] >= cells.size())
      throw Error(fmt::format("has no value for {}", kNames[column]), where);
    return finite_number(cells[places[column]], where);
  };
  Fix fix{number(kTime), number(kLatitude), number(kLongitude), number(kAltitude), {}};
  if (places[kHeight] != kNoColumn) fix.height_m = number(kHeight);
  if (!log.fixes.empty() && fix.time_s <= log.fixes.back().time_s)
    throw Error(fmt::format("time_s is {}, not after the row before; expected times that increase",
                            fix.time_s),
                where);
  add_good(log, fix, where);
  if (log.fixes.size() > 1 && !are_in_reach(*(log.fixes.end() - 2), fix))
    throw Error(
        fmt::format("{}, {}, {} m is out of reach of the row before; expected a position that "
                    "an aircraft reaches",
                    fix.latitude_deg,
                    fix.longitude_deg,
                    fix.altitude_m),
        where);
  if (places[kYaw] != kNoColumn)
    add_good(log, Attitude{fix.time_s, {number(kYaw), number(kPitch), number(kRoll)}}, where);
  if (places[kRateX] != kNoColumn)
    add_good(log, Rates{fix.time_s, {number(kRateX), number(kRateY), number(kRateZ)}}, where);
}

}  // namespace

bool is_csv(std::string_view content) {
  const std::string_view header = line_at_start(without_mark(content));
  return header.find("time_s") != std::string_view::npos &&
         header.find(',') != std::string_view::npos;
}

FlightLog from_csv(std::string_view text, const std::string& file) {
  text = without_mark(text);
  FlightLog log;
  log.format = Format::kCsv;
  const Header header = columns_of(line_at_start(text), file);
  for (int number = 1; !text.empty(); ++number) {
    const std::string_view line = line_at_start(text);
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (number > 1 && line.find_first_not_of(" \t\r") != std::string_view::npos)
      add_row(log, header, line, {file, number});
  }
  return log;
}

}  // namespace airtruth::flight_log
