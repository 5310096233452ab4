// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "encounter/track/track.h"
#include "foundation/base/enum_names.h"

// Encounters in files, in the formats of docs/formats/encounters.md.
namespace airtruth::encounter {

namespace fs = std::filesystem;

enum class TracksFormat {
  kCsv,        // airtruth's own; any number of encounters
  kDaa,        // of DAIDALUS; one encounter
  kTable,      // of MIT-LL's pairing tool; one encounter
  kWaypoints,  // of MIT-LL's em-core, binary; any number of encounters
};
// The names are those of the files' extensions.
constexpr auto enum_names(TracksFormat) {
  return std::to_array<EnumName<TracksFormat>>({{TracksFormat::kCsv, "csv"},
                                                {TracksFormat::kDaa, "daa"},
                                                {TracksFormat::kTable, "txt"},
                                                {TracksFormat::kWaypoints, "dat"}});
}

// The format that the extension of a file names. Throws Error for another extension.
TracksFormat tracks_format_of(const fs::path& file);

// Reads the encounters of a file. A .dat file is binary; any other one is airtruth's CSV where its
// header has a column "encounter", MIT-LL's CSV of a track where it has a column "x_ft", otherwise
// a table of states. Throws Error where the file is larger than 256 MiB, or where it is not of its
// format (state_table.h, waypoint_file.h, encounter_csv.h, track_csv.h).
std::vector<Encounter> read_encounters(const fs::path& file);
std::vector<Encounter> parse_encounters(std::string_view bytes, const fs::path& file);

// The encounters as a file of the format holds them. A format of one encounter takes several
// encounters of one aircraft each as one of all of them, with the number of each behind its name.
// Throws Error where it cannot hold them. `of` names what is written, for messages.
std::vector<Encounter> fitted(std::vector<Encounter> encounters,
                              TracksFormat format,
                              const fs::path& of);

}  // namespace airtruth::encounter
