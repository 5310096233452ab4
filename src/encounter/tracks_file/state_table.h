// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "encounter/track/track.h"

// Tables of states with a row of headings and a row of units: .daa of NASA's DAIDALUS, and the .txt
// that MIT-LL's em-pairing-uncor-importancesampling writes. One file holds one encounter.
// docs/formats/encounters.md names the columns.
namespace airtruth::tracks_file {

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

}  // namespace airtruth::tracks_file
