// SPDX-License-Identifier: Apache-2.0
// GPX 1.0 and 1.1 tracks. Source: Topografix, "GPX 1.1 Schema Documentation".
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "scene/flight_log/builder.h"
#include "scene/flight_log/formats.h"

namespace airtruth::flight_log {
namespace {

// The number in a part of a text; empty where that part is no number.
template <typename Number>
std::optional<Number> number_in(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [rest, failed] = std::from_chars(text.data(), end, value);
  if (failed != std::errc() || rest != end) return std::nullopt;
  return value;
}

// The minutes by which a zone "+02:00" is ahead of UTC; empty where the text is no zone.
std::optional<int> zone_minutes(std::string_view zone) {
  if (zone.empty() || zone == "Z") return 0;
  if (zone.size() != 6 || (zone[0] != '+' && zone[0] != '-') || zone[3] != ':') return std::nullopt;
  const auto hours = number_in<int>(zone.substr(1, 2)), minutes = number_in<int>(zone.substr(4, 2));
  if (!hours || !minutes) return std::nullopt;
  return (zone[0] == '-' ? -1 : 1) * (60 * *hours + *minutes);
}

// "2024-05-17T08:30:05.250Z" as seconds since 1970; empty where the text is no such time.
std::optional<double> seconds_of(std::string_view text) {
  constexpr std::size_t kToMinutes = 17;  // "2024-05-17T08:30:"
  if (text.size() < kToMinutes + 2 || text[4] != '-' || text[7] != '-' || text[10] != 'T' ||
      text[13] != ':' || text[16] != ':')
    return std::nullopt;
  const auto year = number_in<int>(text.substr(0, 4));
  const auto month = number_in<unsigned>(text.substr(5, 2)),
             day = number_in<unsigned>(text.substr(8, 2));
  const auto hour = number_in<int>(text.substr(11, 2)), minute = number_in<int>(text.substr(14, 2));
  const std::size_t end = std::min(text.find_first_of("Z+-", kToMinutes), text.size());
  const auto second = number_in<double>(text.substr(kToMinutes, end - kToMinutes));
  const auto zone = zone_minutes(text.substr(end));
  if (!year || !month || !day || !hour || !minute || !second || !zone) return std::nullopt;
  const std::chrono::year_month_day date{
      std::chrono::year(*year), std::chrono::month(*month), std::chrono::day(*day)};
  if (!date.ok() || *hour > 23 || *minute > 59 || !(*second >= 0 && *second < 61))
    return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return 86400.0 * static_cast<double>(days) + 3600.0 * *hour + 60.0 * (*minute - *zone) + *second;
}

class GpxReader {
 public:
  GpxReader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {
    log_.format = Format::kGpx;
  }

  FlightLog read() {
    pugi::xml_document document;
    const auto parsed = document.load_buffer(text_.data(), text_.size());
    if (!parsed)
      throw Error(fmt::format("is no XML: {}", parsed.description()),
                  {file_, line_of(text_, parsed.offset), 0});
    for (const pugi::xml_node& track : document.child("gpx").children("trk"))
      for (const pugi::xml_node& segment : track.children("trkseg"))
        for (const pugi::xml_node& point : segment.children("trkpt")) add(point);
    return from_first_record(std::move(log_));
  }

 private:
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& message) const {
    throw Error(message, where(node));
  }
  Where where(const pugi::xml_node& node) const {
    return {file_, line_of(text_, node.offset_debug()), 0};
  }

  double number(const pugi::xml_node& point, std::string_view text, const char* what) const {
    const auto value = number_in<double>(trimmed(text));
    if (!value)
      fail(point, fmt::format("{} is '{}'; expected a number", what, printable(trimmed(text))));
    return *value;
  }

  void add(const pugi::xml_node& point) {
    Fix fix;
    fix.latitude_deg = number(point, point.attribute("lat").value(), "lat");
    fix.longitude_deg = number(point, point.attribute("lon").value(), "lon");
    // A point without height or time says where, but not when or how high.
    if (!point.child("ele")) fail(point, "<trkpt> has no <ele>; expected a height in each point");
    fix.altitude_m = number(point, point.child("ele").text().get(), "ele");
    const std::string_view time = trimmed(point.child("time").text().get());
    const auto seconds = seconds_of(time);
    if (!seconds)
      fail(point,
           fmt::format("<time> is '{}'; expected a time such as 2024-05-17T08:30:05Z",
                       printable(time)));
    // Times are kept from the first point on: seconds since 1970 would lose the microseconds.
    if (!first_s_) first_s_ = *seconds;
    fix.time_s = *seconds - *first_s_;
    add_fix(log_, fix, where(point));
  }

  std::string_view text_;
  std::string file_;
  FlightLog log_;
  std::optional<double> first_s_;
};

}  // namespace

bool is_gpx(std::string_view content) {
  // In which a file shows what it is.
  constexpr std::size_t kHeadBytes = 4096;
  return content.substr(0, kHeadBytes).find("<gpx") != std::string_view::npos;
}

FlightLog from_gpx(std::string_view text, const std::string& file) {
  return GpxReader(text, file).read();
}

}  // namespace airtruth::flight_log
