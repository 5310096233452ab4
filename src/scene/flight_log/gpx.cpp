// SPDX-License-Identifier: Apache-2.0
// GPX 1.0 and 1.1 tracks. Source: Topografix, "GPX 1.1 Schema Documentation".
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "scene/flight_log/formats.h"

namespace airtruth::flight_log {
namespace {

// The minutes by which a zone "+02:00" is ahead of UTC; empty where the text is no zone.
std::optional<int> zone_minutes(std::string_view zone) {
  if (zone.empty() || zone == "Z") return 0;
  if (zone.size() != 6 || (zone[0] != '+' && zone[0] != '-') || zone[3] != ':') return std::nullopt;
  const auto hours = number_from_text<int>(zone.substr(1, 2)),
             minutes = number_from_text<int>(zone.substr(4, 2));
  if (!hours || !minutes) return std::nullopt;
  return (zone[0] == '-' ? -1 : 1) * (60 * *hours + *minutes);
}

// "2024-05-17T08:30:05.250Z" as seconds since 1970; empty where the text is no such time.
std::optional<double> seconds_of(std::string_view text) {
  constexpr std::size_t kToMinutes = 17;  // "2024-05-17T08:30:"
  if (text.size() < kToMinutes + 2 || text[4] != '-' || text[7] != '-' || text[10] != 'T' ||
      text[13] != ':' || text[16] != ':')
    return std::nullopt;
  const auto year = number_from_text<int>(text.substr(0, 4));
  const auto month = number_from_text<unsigned>(text.substr(5, 2)),
             day = number_from_text<unsigned>(text.substr(8, 2));
  const auto hour = number_from_text<int>(text.substr(11, 2)),
             minute = number_from_text<int>(text.substr(14, 2));
  const std::size_t end = std::min(text.find_first_of("Z+-", kToMinutes), text.size());
  const auto second = number_from_text<double>(text.substr(kToMinutes, end - kToMinutes));
  const auto zone = zone_minutes(text.substr(end));
  if (!year || !month || !day || !hour || !minute || !second || !zone) return std::nullopt;
  const std::chrono::year_month_day date{
      std::chrono::year(*year), std::chrono::month(*month), std::chrono::day(*day)};
  if (!date.ok() || *hour > 23 || *minute > 59 || !(*second >= 0 && *second < 61))
    return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return 86400.0 * static_cast<double>(days) + 3600.0 * *hour + 60.0 * (*minute - *zone) + *second;
}

// The elements of a name, with or without a prefix of its namespace (gpx:trkpt).
std::vector<pugi::xml_node> children(const pugi::xml_node& node, std::string_view name) {
  std::vector<pugi::xml_node> found;
  for (const pugi::xml_node& child : node.children()) {
    std::string_view local = child.name();
    local.remove_prefix(local.find(':') == std::string_view::npos ? 0 : local.find(':') + 1);
    if (local == name) found.push_back(child);
  }
  return found;
}

std::string_view text_of(const pugi::xml_node& point, const char* name) {
  const auto found = children(point, name);
  return found.empty() ? std::string_view() : trimmed(found.front().text().get());
}

// A point without height or time says where, but not when or how high: it is left out. `first_s`:
// the time of the first point that states one, with which the clock begins whether the point is
// kept or not. Times are kept from there on: seconds since 1970 would lose the microseconds.
void add_point(FlightLog& log,
               std::optional<double>& first_s,
               const pugi::xml_node& point,
               const Where& where) {
  std::string fault;
  const auto number = [&](std::string_view text, const char* what) {
    const auto value = number_from_text<double>(trimmed(text));
    if (!value && fault.empty())
      fault = fmt::format("{} is '{}'; expected a number", what, printable(trimmed(text)));
    return value.value_or(0);
  };
  Fix fix;
  fix.latitude_deg = number(point.attribute("lat").value(), "lat");
  fix.longitude_deg = number(point.attribute("lon").value(), "lon");
  fix.altitude_m = number(text_of(point, "ele"), "<ele>");
  const std::string_view time = text_of(point, "time");
  const auto seconds = seconds_of(time);
  if (!seconds && fault.empty())
    fault = fmt::format("<time> is '{}'; expected a time such as 2024-05-17T08:30:05Z",
                        printable(time));
  if (!first_s) first_s = seconds;
  if (!fault.empty()) return leave_out(log, fault, where);
  fix.time_s = *seconds - *first_s;
  add_record(log, fix, where);
}

}  // namespace

bool is_gpx(std::string_view content) {
  // In which a file shows what it is.
  constexpr std::size_t kHeadBytes = 4096;
  const std::string_view head = content.substr(0, kHeadBytes);
  return head.find("<gpx") != std::string_view::npos || head.find(":gpx") != std::string_view::npos;
}

FlightLog from_gpx(std::string_view text, const std::string& file) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw Error(fmt::format("is no XML: {}", parsed.description()),
                {file, line_of(text, parsed.offset), 0});
  FlightLog log;
  log.format = Format::kGpx;
  std::optional<double> first_s;
  // The points come in the order of the text, whose lines are counted once.
  int line = 1;
  std::ptrdiff_t counted = 0;
  const auto next_line = [&](std::ptrdiff_t offset) {
    if (offset > counted) {
      line += line_of(text.substr(static_cast<std::size_t>(counted)), offset - counted) - 1;
      counted = std::min(offset, std::ssize(text));
    }
    return line;
  };
  for (const pugi::xml_node& track : children(document.document_element(), "trk"))
    for (const pugi::xml_node& segment : children(track, "trkseg"))
      for (const pugi::xml_node& point : children(segment, "trkpt"))
        add_point(log, first_s, point, {file, next_line(point.offset_debug()), 0});
  return log;
}

}  // namespace airtruth::flight_log
