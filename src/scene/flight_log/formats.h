// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstring>
#include <map>
#include <string>
#include <string_view>

#include "foundation/base/error.h"
#include "scene/flight_log/flight_log.h"

// What the readers of the formats share, and one reader for each of them. `file` is the name that
// errors carry. The readers return what the file states.
namespace airtruth::flight_log {

bool is_dji_subtitles(std::string_view content);
FlightLog from_dji_subtitles(std::string_view text, const std::string& file);

bool is_ulog(std::string_view content);
FlightLog from_ulog(std::string_view bytes, const std::string& file);

bool is_dataflash(std::string_view content);
FlightLog from_dataflash(std::string_view bytes, const std::string& file);

bool is_gpx(std::string_view content);
FlightLog from_gpx(std::string_view text, const std::string& file);

// The columns time_s,latitude_deg,longitude_deg,altitude_m and, each optional, height_m;
// yaw_deg,pitch_deg,roll_deg together; rate_x_radps,rate_y_radps,rate_z_radps together.
bool is_csv(std::string_view content);
FlightLog from_csv(std::string_view text, const std::string& file);

// The number of type T at byte `at`, stored with its lowest byte first. `bytes` must hold it.
template <typename T>
T little_endian(std::string_view bytes, std::size_t at) {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// Records are added to a log under the rules that every log obeys. One whose time does not follow
// the one before is left out and counted; loggers repeat a time when they write a value twice, and
// a time that lies before is a fault.

// What is wrong with a record, as a sentence; empty where nothing is: a number that is not finite,
// a latitude beyond 90 degrees, a longitude beyond 180 degrees, a height beyond 100 km, a turn rate
// beyond 1,000 rad/s, and the place 0, 0, which receivers write before they have a fix.
std::string fault_of(const Fix& fix);
std::string fault_of(const Attitude& attitude);
std::string fault_of(const Rates& rates);

// Whether an aircraft can be at both positions at their times.
bool are_in_reach(const Fix& a, const Fix& b);

// Adds a Fix, an Attitude or Rates; one that has a fault is left out.
template <typename Record>
void add_record(FlightLog& log, const Record& record, const Where& where);

// Counts a record that is left out, and keeps the first fault.
void leave_out(FlightLog& log, const std::string& fault, const Where& where);

// The receiver with the lowest number that has two positions; where none has, that with the lowest
// number. An empty log where there is no receiver.
template <typename Number>
FlightLog first_with_fix(const std::map<Number, FlightLog>& receivers) {
  for (const auto& [number, receiver] : receivers)
    if (receiver.fixes.size() >= 2) return receiver;
  return receivers.empty() ? FlightLog() : receivers.begin()->second;
}

// Gives a log the positions of another one, and what that one left out.
void take_positions(FlightLog& log, const FlightLog& positions);

// The log with its times counted from its first record of any kind.
FlightLog from_first_record(FlightLog log);

}  // namespace airtruth::flight_log
