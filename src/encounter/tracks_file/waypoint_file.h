// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "encounter/track/track.h"

// The binary waypoint files of MIT-LL's em-core: little-endian, feet and seconds.
//
//   u32 encounters, u32 aircraft in each
//   of each encounter:  of each aircraft  3 x f64: north, east, altitude at time 0
//                       of each aircraft  u16 n, n x 4 x f64: time, north, east, altitude
//
// Velocities, names and weights have no place in it.
namespace airtruth::tracks_file {

// The names are "own", "intruder", "intruder-2" and so on; "track" where there is one aircraft.
// Throws Error where the file ends early or goes on after the last encounter, a count is 0, a
// number is not finite or beyond 1e9, or the times of an aircraft do not increase.
std::vector<track::Encounter> parse_waypoints(std::string_view bytes,
                                              const std::filesystem::path& file);

// The head of a file, and one encounter of it. Throws Error where an encounter has another number
// of aircraft, its aircraft begin at different times, or one has more than 65536 samples. Times
// are counted from the beginning of the encounter.
std::string waypoint_head(std::uint32_t encounters, std::uint32_t aircraft);
std::string waypoints_of(const track::Encounter& encounter, std::uint32_t aircraft);

}  // namespace airtruth::tracks_file
