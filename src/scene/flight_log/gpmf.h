// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "scene/flight_log/flight_log.h"

namespace airtruth::flight_log {

// Adds the positions of one packet of a GoPro's telemetry (camera/gyro/gpmf.h; streams GPS5 and
// GPS9), spread evenly over [begin_s, end_s) on the video's clock. Positions without a fix in three
// dimensions are left out and counted. A damaged packet adds nothing.
void add_gpmf_packet(FlightLog& log,
                     std::span<const std::uint8_t> packet,
                     double begin_s,
                     double end_s);

}  // namespace airtruth::flight_log
