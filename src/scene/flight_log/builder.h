// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "foundation/base/error.h"
#include "scene/flight_log/flight_log.h"

// Adds records to a log under the rules that every log obeys. A record whose time does not follow
// the one before is left out and counted; loggers repeat a time when they write a value twice.
namespace airtruth::flight_log {

// What is wrong with a record, as a sentence; empty where nothing is: a number that is not finite,
// a latitude beyond 90 degrees, a longitude beyond 180 degrees, a height beyond 100 km, a turn rate
// beyond 1,000 rad/s, and the place 0, 0, which receivers write before they have a fix.
std::string fault_of(const Fix& fix);
std::string fault_of(const Attitude& attitude);
std::string fault_of(const Rates& rates);

// Adds a Fix, an Attitude or Rates; one that has a fault is left out.
template <typename Record>
void add_record(FlightLog& log, const Record& record, const Where& where);

// Counts a record that is left out, and keeps the first fault.
void leave_out(FlightLog& log, const std::string& fault, const Where& where);

// The log without positions that no aircraft reaches from their neighbours: those that are kept
// form the longest run of positions of which each is within reach of the one before, continued on
// both sides by the positions within reach. Throws Error where the log spans more than a day.
FlightLog without_jumps(FlightLog log, const std::string& file);

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

// At most 40 bytes of a file's text for a message of one line: other than printable ASCII becomes
// '?'.
std::string printable(std::string_view text);

// Throws Error where a log has fewer than two positions.
void require_positions(const FlightLog& log, const std::string& file);

}  // namespace airtruth::flight_log
