// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/flight_log/flight_log.h"
#include "scene/trajectory/path.h"

namespace airtruth::flight_log {

// How a log's clock and place relate to a clip's.
struct Placement {
  // Time of the log = time of the clip + offset_s.
  double offset_s = 0;
  // Where the log's position at the clip's first frame lies in the world, metres north-east-down.
  Vector3 first_position_ned_m = Vector3::Zero();
};

// The path of the aircraft on the clip's clock. Positions go from the ellipsoid to a local
// north-east-down frame that is carried along with the aircraft: down is the height above the
// ground however far it flies, and north and east are the sums of the steps on the ellipsoid along
// its meridians and parallels. Logged attitudes and the horizon count from the same directions. A
// C2 spline runs through the means of half seconds. The attitude is the log's where it has one, and
// changes linearly from record to record; else it follows from the path. The path is extended
// by 1.5 s at both ends, for logs of one record a second; it ends so long after the last attitude
// where these end before the positions.
//
// Throws Error (without a file) where the log's positions, or the attitudes of one that has them,
// do not cover the clip's first frame; the message states the range of time that they cover.
// Likewise where they are faster than 10 km/s.
trajectory::Path local_path(const FlightLog& log, const Placement& placement);

// The height above the place of take-off at a time of the log; empty where the log has none there.
std::optional<double> height_at(const FlightLog& log, double time_s);

// The attitude at a time of the log; empty where the log has none there.
std::optional<YawPitchRoll> attitude_at(const FlightLog& log, double time_s);

}  // namespace airtruth::flight_log
