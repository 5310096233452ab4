// SPDX-License-Identifier: Apache-2.0
// Any bytes are a flight log that keeps the rules of flight_log.h, or one error of one line.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "foundation/base/error.h"
#include "scene/flight_log/flight_log.h"
#include "scene/flight_log/local_path.h"

namespace {

template <typename Record>
void require_increasing(const std::vector<Record>& records) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!std::isfinite(records[i].time_s)) std::abort();
    if (i > 0 && !(records[i].time_s > records[i - 1].time_s)) std::abort();
  }
}

void require_rules(const airtruth::flight_log::FlightLog& log) {
  require_increasing(log.fixes);
  require_increasing(log.attitudes);
  require_increasing(log.rates);
  for (const auto& fix : log.fixes)
    if (!(std::abs(fix.latitude_deg) <= 90 && std::abs(fix.longitude_deg) <= 180)) std::abort();
  for (const auto& rates : log.rates)
    if (!rates.in_body_radps.allFinite()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  airtruth::flight_log::FlightLog telemetry;
  airtruth::flight_log::add_gpmf_packet(telemetry, {data, size}, 0, 1);
  require_rules(telemetry);
  try {
    const auto log =
        airtruth::flight_log::parse_flight_log({reinterpret_cast<const char*>(data), size}, "log");
    require_rules(log);
    const auto path = airtruth::flight_log::local_path(log, {log.fixes.front().time_s, {0, 0, 0}});
    const auto state = path.at(0);
    if (!state || !state->position_in_world.allFinite()) std::abort();
  } catch (const airtruth::Error& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
