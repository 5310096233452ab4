// SPDX-License-Identifier: Apache-2.0
#include "scene/flight_log/flight_log.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "scene/flight_log/formats.h"

namespace airtruth::flight_log {
namespace {

constexpr double kMaxTimeS = 1e11;     // seconds since 1970 fit, also of a clock that is off
constexpr double kMaxHeightM = 1e5;    // the border of space
constexpr double kMaxAngleDeg = 1e4;   // some loggers count turns
constexpr double kMaxRateRadps = 1e3;  // gyroscopes of aircraft end at 4,000 degrees a second

// An aircraft moves by less than this in a second, climbs or sinks by less than that, and fixes of
// one place scatter by less than the distance. 330 m/s is a jet fighter's limit in
// docs/flight-limits.md.
constexpr double kFastestBetweenFixesMps = 1e3;
constexpr double kFastestClimbBetweenFixesMps = 330;
constexpr double kScatterM = 100;
// Of a degree of latitude.
constexpr double kMetresOfDegree = 111e3;

// "latitude is 947; expected -90 to 90 degrees" where the value is not good; empty where it is.
std::string unless(bool good, const char* what, double value, const char* expected) {
  return good ? "" : fmt::format("{} is {}; expected {}", what, value, expected);
}

std::string fault_of_time(double time_s) {
  return unless(std::abs(time_s) <= kMaxTimeS, "time", time_s, "seconds up to 1e11");
}

std::string first_of(std::initializer_list<std::string> faults) {
  for (const std::string& fault : faults)
    if (!fault.empty()) return fault;
  return {};
}

}  // namespace

// The plane of the first is near enough: what is excluded is far away.
bool are_in_reach(const Fix& a, const Fix& b) {
  double east = b.longitude_deg - a.longitude_deg;
  east -= 360 * std::round(east / 360);
  const double distance_m = kMetresOfDegree * std::hypot(b.latitude_deg - a.latitude_deg,
                                                         east * std::cos(radians(a.latitude_deg)));
  const double step_s = std::abs(b.time_s - a.time_s);
  return distance_m <= kScatterM + kFastestBetweenFixesMps * step_s &&
         std::abs(b.altitude_m - a.altitude_m) <= kScatterM + kFastestClimbBetweenFixesMps * step_s;
}

std::string fault_of(const Fix& fix) {
  const bool is_place = fix.latitude_deg != 0 || fix.longitude_deg != 0;
  return first_of(
      {fault_of_time(fix.time_s),
       unless(std::abs(fix.latitude_deg) <= 90, "latitude", fix.latitude_deg, "-90 to 90 degrees"),
       unless(std::abs(fix.longitude_deg) <= 180,
              "longitude",
              fix.longitude_deg,
              "-180 to 180 degrees"),
       unless(std::abs(fix.altitude_m) <= kMaxHeightM, "altitude", fix.altitude_m, "up to 1e5 m"),
       unless(!fix.height_m || std::abs(*fix.height_m) <= kMaxHeightM,
              "height",
              fix.height_m.value_or(0),
              "up to 1e5 m"),
       is_place ? "" : "the place is 0, 0; expected one with a fix"});
}

std::string fault_of(const Attitude& attitude) {
  const YawPitchRoll& a = attitude.angles;
  return first_of(
      {fault_of_time(attitude.time_s),
       unless(std::abs(a.yaw_deg) <= kMaxAngleDeg, "yaw", a.yaw_deg, "degrees up to 1e4"),
       unless(std::abs(a.pitch_deg) <= kMaxAngleDeg, "pitch", a.pitch_deg, "degrees up to 1e4"),
       unless(std::abs(a.roll_deg) <= kMaxAngleDeg, "roll", a.roll_deg, "degrees up to 1e4")});
}

std::string fault_of(const Rates& rates) {
  std::string fault = fault_of_time(rates.time_s);
  for (const double rate : rates.in_body_radps)
    if (fault.empty())
      fault = unless(std::abs(rate) <= kMaxRateRadps, "turn rate", rate, "rad/s up to 1e3");
  return fault;
}

void leave_out(FlightLog& log, const std::string& fault, const Where& where) {
  ++log.left_out;
  if (log.first_fault.empty()) log.first_fault = to_string(where) + ": " + fault;
}

template <typename Record>
void add_record(FlightLog& log, const Record& record, const Where& where) {
  auto& records = std::get<std::vector<Record>&>(std::tie(log.fixes, log.attitudes, log.rates));
  if (const std::string fault = fault_of(record); !fault.empty())
    return leave_out(log, fault, where);
  if (records.empty() || record.time_s > records.back().time_s)
    records.push_back(record);
  else if (record.time_s == records.back().time_s)
    ++log.left_out;
  else
    leave_out(
        log,
        fmt::format("time is {:.3f} s, before the {:.3f} s of an earlier record; expected times "
                    "that increase",
                    record.time_s,
                    records.back().time_s),
        where);
}
template void add_record(FlightLog& log, const Fix& fix, const Where& where);
template void add_record(FlightLog& log, const Attitude& attitude, const Where& where);
template void add_record(FlightLog& log, const Rates& rates, const Where& where);

namespace {

// Work and memory follow the time that a log spans: paths are walked in steps, turn rates are
// interpolated to 100 a second. A longer span is a clock that jumps, such as a receiver's before
// its first fix.
constexpr double kMaxSpanS = 86'400;

void expect_span(const FlightLog& log, const std::string& file) {
  double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s;
  double before_s = 0, after_s = 0;  // the longest step
  const auto look = [&](const auto& records) {
    if (records.empty()) return;
    first_s = std::min(first_s, records.front().time_s);
    last_s = std::max(last_s, records.back().time_s);
    for (std::size_t i = 1; i < records.size(); ++i)
      if (records[i].time_s - records[i - 1].time_s > after_s - before_s)
        before_s = records[i - 1].time_s, after_s = records[i].time_s;
  };
  look(log.fixes), look(log.attitudes), look(log.rates);
  if (!(last_s - first_s > kMaxSpanS)) return;
  throw Error(fmt::format("spans {:.0f} s; expected up to {:.0f} s, a day. Its longest step is "
                          "from {:.3f} to {:.3f} s: does its clock jump there?",
                          last_s - first_s,
                          kMaxSpanS,
                          before_s,
                          after_s),
              {file});
}

}  // namespace

FlightLog without_jumps(FlightLog log, const std::string& file) {
  expect_span(log, file);
  const std::vector<Fix>& all = log.fixes;
  std::size_t longest_begin = 0, longest = 0;
  for (std::size_t begin = 0; begin < all.size();) {
    std::size_t end = begin + 1;
    while (end < all.size() && are_in_reach(all[end - 1], all[end])) ++end;
    if (end - begin > longest) longest_begin = begin, longest = end - begin;
    begin = end;
  }
  if (longest == all.size()) return log;
  std::vector<Fix> before, kept(all.begin() + static_cast<std::ptrdiff_t>(longest_begin),
                                all.begin() + static_cast<std::ptrdiff_t>(longest_begin + longest));
  const auto left_out = [&](const Fix& fix) {
    leave_out(
        log,
        fmt::format(
            "the position at {:.3f} s, {:.6f}, {:.6f}, {:.1f} m, is out of reach of the others",
            fix.time_s,
            fix.latitude_deg,
            fix.longitude_deg,
            fix.altitude_m),
        {file});
  };
  for (std::size_t i = longest_begin; i-- > 0;) {
    if (are_in_reach(before.empty() ? kept.front() : before.back(), all[i]))
      before.push_back(all[i]);
    else
      left_out(all[i]);
  }
  for (std::size_t i = longest_begin + longest; i < all.size(); ++i) {
    if (are_in_reach(kept.back(), all[i]))
      kept.push_back(all[i]);
    else
      left_out(all[i]);
  }
  std::ranges::reverse(before);
  before.insert(before.end(), kept.begin(), kept.end());
  log.fixes = std::move(before);
  return log;
}

void take_positions(FlightLog& log, const FlightLog& positions) {
  log.fixes = positions.fixes;
  log.left_out += positions.left_out;
  if (log.first_fault.empty()) log.first_fault = positions.first_fault;
}

FlightLog from_first_record(FlightLog log) {
  double first_s = std::numeric_limits<double>::infinity();
  const auto look = [&](const auto& records) {
    if (!records.empty()) first_s = std::min(first_s, records.front().time_s);
  };
  look(log.fixes), look(log.attitudes), look(log.rates);
  for (Fix& fix : log.fixes) fix.time_s -= first_s;
  for (Attitude& attitude : log.attitudes) attitude.time_s -= first_s;
  for (Rates& rates : log.rates) rates.time_s -= first_s;
  return log;
}

namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 30;  // ten hours of a ULog at 30 kB a second

void require_positions(const FlightLog& log, const std::string& file) {
  if (log.fixes.size() >= 2) return;
  throw Error(
      fmt::format("holds {} {} ({}{}); expected at least two",
                  log.fixes.size(),
                  log.fixes.size() == 1 ? "position" : "positions",
                  name(log.format),
                  log.left_out > 0 ? fmt::format(", {} records left out{}{}",
                                                 log.left_out,
                                                 log.first_fault.empty() ? "" : ", the first: ",
                                                 log.first_fault)
                                   : ""),
      {file});
}

FlightLog read_by_format(std::string_view content, const std::string& file) {
  if (content.empty()) throw Error("is empty; expected a flight log", {file});
  if (is_ulog(content)) return from_ulog(content, file);
  if (is_dataflash(content)) return from_dataflash(content, file);
  if (is_gpx(content)) return from_gpx(content, file);
  if (is_dji_subtitles(content)) return from_dji_subtitles(content, file);
  if (is_csv(content)) return from_csv(content, file);
  throw Error(
      "is no flight log that airtruth reads; expected DJI .srt, PX4 .ulg, ArduPilot .bin, .gpx, "
      "or .csv with time_s,latitude_deg,longitude_deg,altitude_m",
      {file});
}

}  // namespace

const char* name(Format format) {
  constexpr std::array kNames = {
      "DJI subtitles", "GoPro GPMF", "PX4 ULog", "ArduPilot DataFlash", "GPX", "CSV"};
  return kNames[static_cast<std::size_t>(format)];
}

FlightLog parse_flight_log(std::string_view content, const std::filesystem::path& name) {
  const std::string file = name.string();
  FlightLog log = without_jumps(read_by_format(content, file), file);
  require_positions(log, file);
  return log;
}

FlightLog read_flight_log(const std::filesystem::path& path) {
  return parse_flight_log(read_file(path, kMaxBytes), path);
}

}  // namespace airtruth::flight_log
