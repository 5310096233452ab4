// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "encounter/track/track.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"

// Encounters in files, in the formats of docs/formats/encounters.md.
namespace airtruth::tracks_file {

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

// Whether a file holds any number of encounters.
constexpr bool holds_many(TracksFormat format) {
  return format == TracksFormat::kCsv || format == TracksFormat::kWaypoints;
}

// The format that the extension of a file names. Throws Error for another extension.
TracksFormat tracks_format_of(const fs::path& file);

// Reads the encounters of a file. A .dat file is binary; any other one is airtruth's CSV where its
// header has a column "encounter", MIT-LL's CSV of a track where it has a column "x_ft", otherwise
// a table of states. Throws Error where the file is larger than 256 MiB, or where it is not of its
// format (formats.h).
std::vector<track::Encounter> read_encounters(const fs::path& file);
std::vector<track::Encounter> parse_encounters(std::string_view bytes, const fs::path& file);

// The encounters as a file of the format holds them. A format of one encounter takes several
// encounters of one aircraft each as one of all of them, with the number of each behind its name.
// Throws Error where it cannot hold them. `of` names what is written, for messages.
std::vector<track::Encounter> fitted(std::vector<track::Encounter> encounters,
                                     TracksFormat format,
                                     const fs::path& of);

// A file of encounters is written piece by piece (write_file() of files.h), so that a large set
// never stands in memory: the bytes of its head, which announces the number of encounters and of
// aircraft in each, and those of each encounter.
std::string head_of(TracksFormat format, std::uint32_t encounters, std::uint32_t aircraft);

// The bytes of encounter `number` (from 1) in a file whose encounters have `aircraft` aircraft.
// Throws Error where the format cannot hold it.
std::string bytes_of(const track::Encounter& encounter,
                     TracksFormat format,
                     std::uint64_t number,
                     std::uint32_t aircraft);

// Writes all encounters, which fitted() fits to the file's format. Throws Error where the format
// cannot hold them or the file cannot be written.
void write_encounters(const fs::path& file, const std::vector<track::Encounter>& encounters);

}  // namespace airtruth::tracks_file
