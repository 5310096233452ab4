// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "encounter/track/track.h"

// The readers and writers of the single formats (docs/formats/encounters.md).
namespace airtruth::tracks_file {

// Encounters as CSV, the format of airtruth's own: a header, then one row for each state, with the
// columns
//
//   encounter,aircraft,time_s,north_m,east_m,down_m[,north_mps,east_mps,down_mps][,weight]
//
// in any order. The rows of an encounter stand together, and their times increase for each
// aircraft. The first aircraft of an encounter is the own one.

// Throws Error with file and line where a column is missing, unknown or twice there, a row has
// another number of cells, a cell is no finite number, a time of an aircraft does not increase, the
// rows of an encounter are apart, or its weights differ or are not positive.
std::vector<track::Encounter> parse_encounter_csv(std::string_view text,
                                                  const std::filesystem::path& file);

// The header with all columns, and the rows of encounter `number` (from 1). Numbers are written so
// that reading gives the same ones.
std::string encounter_csv_head();
std::string encounter_csv_rows(const track::Encounter& encounter, std::uint64_t number);

// Tables of states with a row of headings and a row of units: .daa of NASA's DAIDALUS, and the .txt
// that MIT-LL's em-pairing-uncor-importancesampling writes. One file holds one encounter.

// Reads either kind. The first aircraft of the file is the own one. Latitudes and longitudes become
// a plane that touches the sphere of one nautical mile a minute of arc at the file's first
// position (orthographic projection; Snyder 1987, eq. 20-3 and 20-4), as in DAIDALUS.
//
// Throws Error with file and line where a column is missing or twice there, a column has no unit or
// one of another dimension, a row has another number of cells, a cell is no finite number, a ground
// speed is negative, the times of an aircraft do not increase, or there is one aircraft only.
track::Encounter parse_state_table(std::string_view text, const std::filesystem::path& file);

// The columns of DAIDALUS with sx, sy, sz and vx, vy, vz in SI; all aircraft of a time in a block,
// the own one first. Throws Error where there are fewer than two aircraft.
std::string daa_of(const track::Encounter& encounter);

// The columns of MIT-LL's tool in feet, radians and feet per second; one aircraft after the other.
// Throws Error where there are fewer than two aircraft.
std::string state_table_of(const track::Encounter& encounter);

// The CSV of one track that MIT-LL's em-model-manned-bayes writes (sample2track.m): the header
//
//   time_s,x_ft,y_ft,z_ft
//
// and a row for each second, in whole feet. x is along the course at the beginning and y to its
// right, so the track begins northward: x is north, y is east, z is the altitude.

// One aircraft, named "track", without velocities. Throws Error with file and line where a column
// is missing, unknown or twice there, a row has another number of cells, a cell is no finite
// number, a time does not increase, or there is no row.
track::Encounter parse_track_csv(std::string_view text, const std::filesystem::path& file);

// The binary waypoint files of MIT-LL's em-core: little-endian, feet and seconds.
//
//   u32 encounters, u32 aircraft in each
//   of each encounter:  of each aircraft  3 x f64: north, east, altitude at time 0
//                       of each aircraft  u16 n, n x 4 x f64: time, north, east, altitude
//
// Velocities, names and weights have no place in it.

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
