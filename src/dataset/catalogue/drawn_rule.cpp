// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/drawn_rule.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "aircraft/fleet/fleet.h"
#include "dataset/catalogue/names.h"
#include "dataset/catalogue/sun_position.h"

namespace airtruth::dataset {
namespace {

using scene::TableReader;

constexpr std::int64_t kMaxIntruders = 100;
constexpr std::int64_t kMaxDrawnFrames = 1'000'000;  // 9 h at 30 frames/s
constexpr const char* kSuitsType = "type";

Range range_in(const TableReader& table, std::string_view key, const scene::Limits& limits) {
  const auto values = table.tuple(key, {limits, limits});
  if ((*values)[0] > (*values)[1])
    table.fail(key, std::string(key) + " falls; expected [low, high]");
  return {(*values)[0], (*values)[1]};
}

// The range at `key`; empty where the key is absent.
std::optional<Range> maybe_range(const TableReader& table,
                                 std::string_view key,
                                 const scene::Limits& limits) {
  if (!table.has(key)) return std::nullopt;
  return range_in(table, key, limits);
}

// Reads "type" or [low, high]; empty for "type".
std::optional<Range> range_or_type(const TableReader& table,
                                   std::string_view key,
                                   const scene::Limits& limits) {
  if (table.says(key, kSuitsType)) return std::nullopt;
  return maybe_range(table, key, limits);
}

// The aircraft that match the patterns, grouped by the folder of their name, which is their type.
std::string no_aircraft_fits(const std::string& pattern) {
  const std::string text = "no aircraft fits '" + pattern + "'";
  const std::string wider = "*" + pattern + "*";
  const std::vector<std::string> names = aircraft::aircraft_fitting(wider);
  if (!names.empty())
    return text + "; '" + wider + "' fits " + std::to_string(names.size()) + ", the first '" +
           names.front() + "'";
  std::string nearest;
  for (const std::string& name : aircraft::nearest_aircraft(pattern, 1))
    nearest = "; the nearest name is '" + name + "'";
  return text + nearest + "; see `airtruth aircraft list`";
}

std::optional<DaytimeRange> daytime_from(const TableReader& table) {
  table.exclude("time_of_day_h", {"sun_azimuth_deg", "sun_elevation_deg"});
  for (const char* key : {"latitude_deg", "day_of_year"})
    if (table.has(key) && !table.has("time_of_day_h"))
      table.fail(key, fmt::format("{} is for time_of_day_h, which is not there", key));
  if (!table.has("time_of_day_h")) return std::nullopt;
  DaytimeRange daytime;
  daytime.hours = range_or_type(
      table,
      "time_of_day_h",
      {.expected = "[low, high] in hours from 0 to 24, or \"type\"", .low = 0, .high = 24});
  daytime.latitude_deg =
      table.number("latitude_deg", {.expected = "degrees from -90 to 90", .low = -90, .high = 90})
          .value_or(daytime.latitude_deg);
  daytime.day_of_year = static_cast<int>(table.whole("day_of_year", 1, 366).value_or(172));
  const auto light = daylight_hours(daytime.latitude_deg, daytime.day_of_year);
  const Range asked = daytime.hours.value_or(Range{0, 24});
  if (!light || light->high < asked.low || light->low > asked.high)
    table.fail("time_of_day_h",
               light
                   ? fmt::format("time_of_day_h is dark; there the sun is up from {:.1f} to {:.1f}",
                                 light->low,
                                 light->high)
                   : "time_of_day_h is dark: the sun does not rise there on that day");
  return daytime;
}

void read_intruders(const TableReader& table, double usual_negatives, Drawn& drawn) {
  drawn.negatives =
      table.number("negatives", {.expected = "a share from 0 to 1", .low = 0, .high = 1})
          .value_or(usual_negatives);
  drawn.numbers_intruders = table.has("intruders");
  if (!drawn.numbers_intruders) return;
  if (table.is_array("intruders")) {
    const Range range = range_in(
        table,
        "intruders",
        {.expected = "a whole number from 1 to 100", .low = 1, .high = double(kMaxIntruders)});
    drawn.fewest_intruders = static_cast<std::int64_t>(range.low);
    drawn.most_intruders = static_cast<std::int64_t>(range.high);
    if (double(drawn.fewest_intruders) != range.low || double(drawn.most_intruders) != range.high)
      table.fail("intruders", "intruders is no whole number; expected a number or [low, high]");
    return;
  }
  drawn.fewest_intruders = *table.whole("intruders", 1, kMaxIntruders);
  drawn.most_intruders = drawn.fewest_intruders;
}

// A clip may begin at a random frame only where the camera flies equally steadily at any time. A
// camera path is tied to the frame at which it begins.
void read_start(const TableReader& table, const Catalogue& catalogue, Drawn& drawn) {
  drawn.start = table.choice<ClipStart>("start").value_or(drawn.start);
  if (drawn.start != ClipStart::kRandom) return;
  for (const std::size_t i : drawn.backgrounds)
    if (catalogue.backgrounds[i].camera.path_file || catalogue.backgrounds[i].camera.log)
      table.fail("start",
                 "start is random, but the camera of background '" + catalogue.backgrounds[i].name +
                     "' has a path_file or log, which belongs to its first frame; expected start = "
                     "\"first\"");
}

void read_paths(const TableReader& table, Drawn& drawn) {
  const TableReader::Keys meeting = {"range_m",
                                     "size_px",
                                     "azimuth_deg",
                                     "elevation_deg",
                                     "speed_mps",
                                     "heading_deg",
                                     "climb_deg",
                                     "bank_deg"};
  table.exclude("encounter", {"seen"});
  table.exclude("encounter", meeting);
  table.exclude("seen", meeting);
  drawn.approach = drawn_approach_in(table);
  drawn.seen = drawn_seen_in(table);
  table.exclude("size_px", {"range_m"});
  drawn.range_m = maybe_range(table, "range_m", scene::kRangeToAircraft).value_or(drawn.range_m);
  drawn.size_px = maybe_range(table, "size_px", scene::kApparentSize);
  drawn.azimuth_deg = maybe_range(table, "azimuth_deg", scene::kTurn).value_or(drawn.azimuth_deg);
  drawn.elevation_deg =
      maybe_range(table, "elevation_deg", scene::kPitch).value_or(drawn.elevation_deg);
  drawn.speed_mps = range_or_type(table, "speed_mps", scene::kSpeed);
  drawn.heading_deg = maybe_range(table, "heading_deg", scene::kTurn).value_or(drawn.heading_deg);
  drawn.climb_deg = range_or_type(table, "climb_deg", scene::kPitch);
  drawn.bank_deg = range_or_type(
      table,
      "bank_deg",
      {.expected = "[low, high] in degrees from -85 to 85, or \"type\"", .low = -85, .high = 85});
  drawn.bank_suits_type = table.has("bank_deg") && !drawn.bank_deg;
}

Drawn drawn_from(const TableReader& table, const Catalogue& catalogue) {
  Drawn drawn;
  drawn.where = table.where();
  drawn.name = table.file_name("name").value_or("r{index}");
  expect_parts(table, drawn.name, {"{index}"});
  if (drawn.name.find("{index}") == std::string::npos)
    table.fail("name", "name has no {index}; every sequence needs its own");
  drawn.count = table.whole("count", 1, kMost).value_or(1);
  drawn.frame_count = table.whole("frame_count", 1, kMaxDrawnFrames).value_or(drawn.frame_count);
  drawn.backgrounds = places_of(table, "backgrounds", catalogue.backgrounds, "background");
  drawn.types = types_in(table);
  read_paths(table, drawn);
  read_intruders(table, catalogue.negatives, drawn);
  read_start(table, catalogue, drawn);
  drawn.daytime = daytime_from(table);
  drawn.sun_azimuth_deg = maybe_range(table, "sun_azimuth_deg", scene::kTurn);
  drawn.sun_elevation_deg = maybe_range(table, "sun_elevation_deg", scene::kPitch);
  return drawn;
}

}  // namespace

std::vector<AircraftType> types_in(const TableReader& table) {
  const auto patterns = table.texts("aircraft");
  if (!patterns)
    throw Error("has no aircraft; expected names or patterns of `airtruth aircraft list`",
                table.where());
  std::map<std::string, AircraftType> types;
  for (std::size_t i = 0; i < patterns->size(); ++i) {
    const std::vector<std::string> names = aircraft::aircraft_fitting((*patterns)[i]);
    for (const std::string& name : names) {
      const std::string type = name.substr(0, name.find('/'));
      types[type].name = type;
      types[type].liveries.push_back(name);
    }
    if (names.empty()) throw Error(no_aircraft_fits((*patterns)[i]), table.where("aircraft", i));
  }
  std::vector<AircraftType> result;
  for (auto& [name, type] : types) {
    std::sort(type.liveries.begin(), type.liveries.end());
    type.liveries.erase(std::unique(type.liveries.begin(), type.liveries.end()),
                        type.liveries.end());
    result.push_back(std::move(type));
  }
  return result;
}

std::vector<Drawn> drawn_rules(const TableReader& root, const Catalogue& catalogue) {
  std::vector<Drawn> result;
  for (const TableReader& table : root.tables(
           "random",
           {"name",          "count",        "frame_count", "backgrounds",     "aircraft",
            "range_m",       "size_px",      "azimuth_deg", "elevation_deg",   "speed_mps",
            "heading_deg",   "climb_deg",    "bank_deg",    "sun_azimuth_deg", "sun_elevation_deg",
            "time_of_day_h", "latitude_deg", "day_of_year", "negatives",       "intruders",
            "start",         "encounter",    "seen"}))
    result.push_back(drawn_from(table, catalogue));
  return result;
}

}  // namespace airtruth::dataset
