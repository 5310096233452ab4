// SPDX-License-Identifier: Apache-2.0
#include "encounter/tracks_file/tracks_file.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "encounter/tracks_file/encounter_csv.h"
#include "encounter/tracks_file/state_table.h"
#include "encounter/tracks_file/track_builder.h"
#include "encounter/tracks_file/track_csv.h"
#include "encounter/tracks_file/waypoint_file.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::encounter {
namespace {

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

std::vector<Encounter> read_encounters(const fs::path& file) {
  tracks_format_of(file);
  return parse_encounters(read_file(file, kMaxBytes), file);
}

std::vector<Encounter> parse_encounters(std::string_view bytes, const fs::path& file) {
  if (tracks_format_of(file) == TracksFormat::kWaypoints) return parse_waypoints(bytes, file);
  if (is_encounter_csv(bytes)) return parse_encounter_csv(bytes, file);
  if (is_track_csv(bytes)) return {parse_track_csv(bytes, file)};
  return {parse_state_table(bytes, file)};
}

std::vector<Encounter> fitted(std::vector<Encounter> encounters,
                              TracksFormat format,
                              const fs::path& of) {
  const bool holds_many = format == TracksFormat::kCsv || format == TracksFormat::kWaypoints;
  if (holds_many || encounters.size() <= 1) return encounters;
  const bool is_of_one =
      std::all_of(encounters.begin(), encounters.end(), [](const Encounter& each) {
        return each.aircraft.size() == 1;
      });
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
  Encounter all;
  for (std::size_t i = 0; i < encounters.size(); ++i) {
    Track& track = encounters[i].aircraft[0];
    track.name += fmt::format("-{}", i + 1);
    all.aircraft.push_back(std::move(track));
  }
  return {std::move(all)};
}

}  // namespace airtruth::encounter
