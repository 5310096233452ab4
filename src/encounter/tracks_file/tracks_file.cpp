// SPDX-License-Identifier: Apache-2.0
#include "encounter/tracks_file/tracks_file.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "encounter/tracks_file/formats.h"
#include "encounter/tracks_file/table_text.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::tracks_file {
namespace {

// Largest file that is read: it bounds memory.
constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

}  // namespace

TracksFormat tracks_format_of(const fs::path& file) {
  const std::string extension = file.extension().string();
  const auto format =
      extension.empty() ? std::nullopt : enum_named<TracksFormat>(extension.substr(1));
  if (!format)
    throw Error(fmt::format("has the extension '{}'; expected .{}",
                            extension,
                            fmt::join(all_enum_names<TracksFormat>(), ", .")),
                {file.string()});
  return *format;
}

std::vector<track::Encounter> read_encounters(const fs::path& file) {
  tracks_format_of(file);
  return parse_encounters(read_file(file, kMaxBytes), file);
}

std::vector<track::Encounter> parse_encounters(std::string_view bytes, const fs::path& file) {
  if (tracks_format_of(file) == TracksFormat::kWaypoints) return parse_waypoints(bytes, file);
  if (begins_with_column(bytes, "encounter")) return parse_encounter_csv(bytes, file);
  if (begins_with_column(bytes, "x_ft")) return {parse_track_csv(bytes, file)};
  return {parse_state_table(bytes, file)};
}

std::vector<track::Encounter> fitted(std::vector<track::Encounter> encounters,
                                     TracksFormat format,
                                     const fs::path& of) {
  if (holds_many(format) || encounters.size() <= 1) return encounters;
  const bool is_of_one = std::ranges::all_of(
      encounters, [](const track::Encounter& each) { return each.aircraft.size() == 1; });
  if (!is_of_one)
    throw Error(
        fmt::format("would hold {} encounters, and a .{} file holds one; choose one of them, "
                    "or .csv or .dat",
                    encounters.size(),
                    enum_name(format)),
        {of.string()});
  if (encounters.size() > kMaxAircraft)
    throw Error(
        fmt::format("would hold {} aircraft; expected up to {}", encounters.size(), kMaxAircraft),
        {of.string()});
  track::Encounter all;
  for (std::size_t i = 0; i < encounters.size(); ++i) {
    track::Track& track = encounters[i].aircraft[0];
    track.name += fmt::format("-{}", i + 1);
    all.aircraft.push_back(std::move(track));
  }
  return {std::move(all)};
}

std::string head_of(TracksFormat format, std::uint32_t encounters, std::uint32_t aircraft) {
  if (format == TracksFormat::kCsv) return encounter_csv_head();
  if (format == TracksFormat::kWaypoints) return waypoint_head(encounters, aircraft);
  return {};
}

std::string bytes_of(const track::Encounter& encounter,
                     TracksFormat format,
                     std::uint64_t number,
                     std::uint32_t aircraft) {
  switch (format) {
    case TracksFormat::kCsv:
      return encounter_csv_rows(encounter, number);
    case TracksFormat::kDaa:
      return daa_of(encounter);
    case TracksFormat::kTable:
      return state_table_of(encounter);
    case TracksFormat::kWaypoints:
      return waypoints_of(encounter, aircraft);
  }
  return {};
}

void write_encounters(const fs::path& file, const std::vector<track::Encounter>& encounters) {
  check(!encounters.empty(), "there are encounters to write");
  const TracksFormat format = tracks_format_of(file);
  const auto aircraft = static_cast<std::uint32_t>(encounters.front().aircraft.size());
  write_file(file, [&](const AddBytes& add) {
    add(head_of(format, static_cast<std::uint32_t>(encounters.size()), aircraft));
    for (std::size_t i = 0; i < encounters.size(); ++i)
      add(bytes_of(encounters[i], format, i + 1, aircraft));
  });
}

}  // namespace airtruth::tracks_file
