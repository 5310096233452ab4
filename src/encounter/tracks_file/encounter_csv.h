// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "encounter/track/track.h"

// Encounters as CSV, the format of airtruth's own: a header, then one row for each state, with the
// columns
//
//   encounter,aircraft,time_s,north_m,east_m,down_m[,north_mps,east_mps,down_mps][,weight]
//
// in any order. The rows of an encounter stand together, and their times increase for each
// aircraft. The first aircraft of an encounter is the own one.
namespace airtruth::tracks_file {

// Throws Error with file and line where a column is missing, unknown or twice there, a row has
// another number of cells, a cell is no finite number, a time of an aircraft does not increase, the
// rows of an encounter are apart, or its weights differ or are not positive.
std::vector<track::Encounter> parse_encounter_csv(std::string_view text,
                                                  const std::filesystem::path& file);

// The header with all columns, and the rows of encounter `number` (from 1). Numbers are written so
// that reading gives the same ones.
std::string encounter_csv_head();
std::string encounter_csv_rows(const track::Encounter& encounter, std::uint64_t number);

}  // namespace airtruth::tracks_file
