// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "encounter/track/track.h"

// The CSV of one track that MIT-LL's em-model-manned-bayes writes (sample2track.m): the header
//
//   time_s,x_ft,y_ft,z_ft
//
// and a row for each second, in whole feet. x is along the course at the beginning and y to its
// right, so the track begins northward: x is north, y is east, z is the altitude.
namespace airtruth::tracks_file {

// One aircraft, named "track", without velocities. Throws Error with file and line where a column
// is missing, unknown or twice there, a row has another number of cells, a cell is no finite
// number, a time does not increase, or there is no row.
track::Encounter parse_track_csv(std::string_view text, const std::filesystem::path& file);

}  // namespace airtruth::tracks_file
