// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/base/error.h"
#include "scene/flight_log/flight_log.h"

// Adds records to a log under the rules that every log obeys. A record whose time does not follow
// the one before is left out and counted; loggers repeat a time when they write a value twice.
namespace airtruth::flight_log {

// Throws Error where a number is not finite, a latitude is beyond 90 degrees, a longitude beyond
// 180 degrees, or a height beyond 100 km.
void add_fix(FlightLog& log, const Fix& fix, const Where& where);
void add_attitude(FlightLog& log, const Attitude& attitude, const Where& where);
// Throws Error beyond 1,000 rad/s.
void add_rates(FlightLog& log, const Rates& rates, const Where& where);

// The log with its times counted from its first record of any kind.
FlightLog from_first_record(FlightLog log);

// At most 40 bytes of a file's text for a message of one line: other than printable ASCII becomes
// '?'.
std::string printable(std::string_view text);

// Throws Error where a log has fewer than two positions.
void require_positions(const FlightLog& log, const std::string& file);

}  // namespace airtruth::flight_log
