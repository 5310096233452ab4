// SPDX-License-Identifier: Apache-2.0
#include "scene/flight_log/builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace airtruth::flight_log {
namespace {

constexpr double kMaxTimeS = 1e11;     // seconds since 1970 fit, also of a clock that is off
constexpr double kMaxHeightM = 1e5;    // the border of space
constexpr double kMaxAngleDeg = 1e4;   // some loggers count turns
constexpr double kMaxRateRadps = 1e3;  // gyroscopes of aircraft end at 4,000 degrees a second

void require(bool good, const char* what, double value, const char* expected, const Where& where) {
  if (!good) throw Error(fmt::format("{} is {}; expected {}", what, value, expected), where);
}

void require_time(double time_s, const Where& where) {
  require(std::abs(time_s) <= kMaxTimeS, "time", time_s, "seconds up to 1e11", where);
}

// True where the record follows the one before in time; counts it otherwise.
template <typename Record>
bool follows(FlightLog& log, const std::vector<Record>& records, double time_s) {
  if (records.empty() || time_s > records.back().time_s) return true;
  ++log.left_out;
  return false;
}

}  // namespace

void add_fix(FlightLog& log, const Fix& fix, const Where& where) {
  require_time(fix.time_s, where);
  require(
      std::abs(fix.latitude_deg) <= 90, "latitude", fix.latitude_deg, "-90 to 90 degrees", where);
  require(std::abs(fix.longitude_deg) <= 180,
          "longitude",
          fix.longitude_deg,
          "-180 to 180 degrees",
          where);
  require(
      std::abs(fix.altitude_m) <= kMaxHeightM, "altitude", fix.altitude_m, "up to 1e5 m", where);
  if (fix.height_m)
    require(std::abs(*fix.height_m) <= kMaxHeightM, "height", *fix.height_m, "up to 1e5 m", where);
  if (follows(log, log.fixes, fix.time_s)) log.fixes.push_back(fix);
}

void add_attitude(FlightLog& log, const Attitude& attitude, const Where& where) {
  require_time(attitude.time_s, where);
  const YawPitchRoll& a = attitude.angles;
  require(std::abs(a.yaw_deg) <= kMaxAngleDeg, "yaw", a.yaw_deg, "degrees up to 1e4", where);
  require(std::abs(a.pitch_deg) <= kMaxAngleDeg, "pitch", a.pitch_deg, "degrees up to 1e4", where);
  require(std::abs(a.roll_deg) <= kMaxAngleDeg, "roll", a.roll_deg, "degrees up to 1e4", where);
  if (follows(log, log.attitudes, attitude.time_s)) log.attitudes.push_back(attitude);
}

void add_rates(FlightLog& log, const Rates& rates, const Where& where) {
  require_time(rates.time_s, where);
  for (const double rate : rates.in_body_radps)
    require(std::abs(rate) <= kMaxRateRadps, "turn rate", rate, "rad/s up to 1e3", where);
  if (follows(log, log.rates, rates.time_s)) log.rates.push_back(rates);
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

std::string printable(std::string_view text) {
  // A message repeats at most this much of a text, so that it stays on one line.
  constexpr std::size_t kMaxShownBytes = 40;
  std::string result(text.substr(0, kMaxShownBytes));
  for (char& c : result)
    if (c < 0x20 || c >= 0x7f) c = '?';
  return result;
}

void require_positions(const FlightLog& log, const std::string& file) {
  if (log.fixes.size() >= 2) return;
  throw Error(
      fmt::format("holds {} {} ({}{}); expected at least two",
                  log.fixes.size(),
                  log.fixes.size() == 1 ? "position" : "positions",
                  name(log.format),
                  log.left_out > 0 ? fmt::format(", {} records left out", log.left_out) : ""),
      {file});
}

}  // namespace airtruth::flight_log
