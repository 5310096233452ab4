// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/drawn_rule.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "aircraft/fleet/fleet.h"
#include "dataset/catalogue/catalogue.h"
#include "dataset/catalogue/drawing.h"
#include "foundation/base/error.h"
#include "scene/scene/tables.h"

namespace airtruth::catalogue {
namespace {

using scene::TableReader;

constexpr std::int64_t kMaxDrawnFrames = 1'000'000;  // 9 h at 30 frames/s
constexpr const char* kSuitsType = "type";

// Reads "type" or [low, high]; empty for "type".
std::optional<Range> range_or_type(const TableReader& table,
                                   std::string_view key,
                                   const scene::Limits& limits) {
  if (table.says(key, kSuitsType)) return std::nullopt;
  return maybe_range(table, key, limits);
}

std::string index_pattern(const TableReader& table, const char* usual) {
  const std::string pattern = table.file_name("name").value_or(usual);
  expect_parts(table, pattern, {"{index}"});
  if (pattern.find("{index}") == std::string::npos)
    table.fail("name", "name has no {index}; every sequence needs its own");
  return pattern;
}

// Says that a pattern fits no aircraft, and what would.
std::string no_aircraft_fits(const std::string& pattern) {
  const std::string text = "no aircraft fits '" + pattern + "'";
  const std::string wider = "*" + pattern + "*";
  const std::vector<std::string> names = fleet::aircraft_fitting(wider);
  if (!names.empty())
    return text + "; '" + wider + "' fits " + std::to_string(names.size()) + ", the first '" +
           names.front() + "'";
  std::string nearest;
  for (const std::string& name : fleet::nearest_aircraft(pattern, 1))
    nearest = "; the nearest name is '" + name + "'";
  return text + nearest + "; see `airtruth aircraft list`";
}

// The type of an aircraft is the folder of its name.
std::vector<AircraftType> types_in(const TableReader& table) {
  const auto patterns = table.texts("aircraft");
  if (!patterns)
    throw Error("has no aircraft; expected names or patterns of `airtruth aircraft list`",
                table.where());
  std::map<std::string, std::set<std::string>> liveries_of;
  for (std::size_t i = 0; i < patterns->size(); ++i) {
    const std::vector<std::string> names = fleet::aircraft_fitting((*patterns)[i]);
    for (const std::string& name : names) liveries_of[name.substr(0, name.find('/'))].insert(name);
    if (names.empty()) throw Error(no_aircraft_fits((*patterns)[i]), table.where("aircraft", i));
  }
  std::vector<AircraftType> result;
  for (const auto& [type, liveries] : liveries_of)
    result.push_back({type, {liveries.begin(), liveries.end()}});
  return result;
}

std::optional<DaytimeRange> daytime_from(const TableReader& table) {
  table.exclude("time_of_day_h", {"sun_azimuth_deg", "sun_elevation_deg"});
  for (const char* key : {"latitude_deg", "day_of_year"})
    if (table.has(key) && !table.has("time_of_day_h"))
      table.fail(key, fmt::format("{} is for time_of_day_h, which is not there", key));
  if (!table.has("time_of_day_h")) return std::nullopt;
  DaytimeRange daytime;
  daytime.hours = range_or_type(
      table, "time_of_day_h", {"[low, high] in hours from 0 to 24, or \"type\"", 0, 24});
  daytime.latitude_deg = table.number("latitude_deg", {"degrees from -90 to 90", -90, 90})
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
      table.number("negatives", {"a share from 0 to 1", 0, 1}).value_or(usual_negatives);
  drawn.numbers_intruders = table.has("intruders");
  drawn.intruders = whole_range(table, "intruders", kMaxIntruders).value_or(drawn.intruders);
}

// A clip may begin at a random frame only where the camera flies equally steadily at any time. A
// camera path is tied to the frame at which it begins.
void read_start(const TableReader& table, const Catalogue& catalogue, Drawn& drawn) {
  drawn.starts_at_random = table.choice("start", {"first", "random"}) == "random";
  if (!drawn.starts_at_random) return;
  for (const std::size_t i : drawn.backgrounds)
    if (catalogue.backgrounds[i].camera.path_file || catalogue.backgrounds[i].camera.log)
      table.fail("start",
                 "start is random, but the camera of background '" + catalogue.backgrounds[i].name +
                     "' has a path_file or log, which belongs to its first frame; expected start = "
                     "\"first\"");
}

std::optional<DrawnNumber> number_in(const TableReader& table,
                                     std::string_view key,
                                     const scene::Limits& limits) {
  if (!table.has(key)) return std::nullopt;
  DrawnNumber drawn;
  if (table.is_table(key)) {
    drawn.any_of =
        table.table(key, {"any_of"}).numbers("any_of", limits).value_or(std::vector<double>{});
    if (drawn.any_of.empty())
      table.fail(key, fmt::format("{} has no any_of; expected a list of numbers", key));
    drawn.low = std::ranges::min(drawn.any_of);
    drawn.high = std::ranges::max(drawn.any_of);
  } else if (table.is_array(key)) {
    const Range range = range_in(table, key, limits);
    drawn.low = range.low;
    drawn.high = range.high;
  } else {
    drawn.low = drawn.high = *table.number(key, limits);
  }
  return drawn;
}

DrawnNumber fixed(double value) { return {value, value, {}}; }

void read_pixel(const TableReader& table, DrawnSeen& seen) {
  table.exclude("pixel", {"x_px", "y_px"});
  const auto pixel = table.tuple<Pixel>("pixel", scene::kPixel);
  const auto x_px = number_in(table, "x_px", scene::kPixel);
  const auto y_px = number_in(table, "y_px", scene::kPixel);
  if (!pixel && !(x_px && y_px))
    throw Error("[[random.seen]] has no pixel; expected pixel = [x, y], or x_px and y_px",
                table.where());
  seen.x_px = pixel ? fixed((*pixel)[0]) : *x_px;
  seen.y_px = pixel ? fixed((*pixel)[1]) : *y_px;
}

DrawnSeen seen_from(const TableReader& table) {
  DrawnSeen seen;
  seen.where = table.where();
  const auto time_s = number_in(table, "time_s", scene::kTime);
  if (!time_s) throw Error("[[random.seen]] has no time_s; expected seconds", table.where());
  seen.time_s = *time_s;
  read_pixel(table, seen);
  table.exclude("range_m", {"width_px"});
  seen.range_m = number_in(table, "range_m", scene::kRangeToAircraft);
  seen.width_px = number_in(table, "width_px", scene::kApparentSize);
  if (!seen.range_m && !seen.width_px)
    throw Error("[[random.seen]] has no range_m and no width_px; expected one of them",
                table.where());
  return seen;
}

std::optional<DrawnApproach> drawn_approach_in(const TableReader& rule) {
  if (!rule.has("encounter")) return std::nullopt;
  const TableReader table = rule.table("encounter", scene::kEncounterKeys);
  DrawnApproach drawn;
  drawn.where = table.where();
  drawn.cpa_time_s = number_in(table, "cpa_time_s", scene::kTime);
  drawn.cpa_right_m = number_in(table, "cpa_right_m", scene::kMiss);
  drawn.cpa_ahead_m = number_in(table, "cpa_ahead_m", scene::kMiss);
  drawn.cpa_above_m = number_in(table, "cpa_above_m", scene::kMiss).value_or(drawn.cpa_above_m);
  drawn.course_deg = number_in(table, "course_deg", scene::kTurn).value_or(drawn.course_deg);
  drawn.speed_mps = number_in(table, "speed_mps", scene::kSpeed);
  drawn.climb_mps = number_in(table, "climb_mps", scene::kClimb).value_or(drawn.climb_mps);
  drawn.turn_rate_dps =
      number_in(table, "turn_rate_dps", scene::kTurnRate).value_or(drawn.turn_rate_dps);
  table.exclude("cpa_right_m", {"cpa_ahead_m"});  // drawn apart, they are no closest approach
  const double steepest_mps =
      std::max(std::abs(drawn.climb_mps.low), std::abs(drawn.climb_mps.high));
  if (drawn.speed_mps && steepest_mps > drawn.speed_mps->low)
    table.fail("climb_mps",
               fmt::format("climb_mps reaches {} at a speed_mps of {}; expected no more than the "
                           "speed",
                           steepest_mps,
                           drawn.speed_mps->low));
  return drawn;
}

std::vector<DrawnSeen> drawn_seen_in(const TableReader& rule) {
  std::vector<DrawnSeen> result;
  for (const TableReader& table :
       rule.tables("seen", {"time_s", "pixel", "x_px", "y_px", "range_m", "width_px"})) {
    result.push_back(seen_from(table));
    if (result.size() < 2) continue;
    const DrawnSeen& before = result[result.size() - 2];
    if (!(result.back().time_s.low > before.time_s.high))
      table.fail("time_s",
                 fmt::format("time_s may be {}, not after the {} of the [[random.seen]] before; "
                             "expected later times",
                             result.back().time_s.low,
                             before.time_s.high));
  }
  if (result.size() == 1)
    throw Error("[[random.seen]] is alone; expected at least two of them", result[0].where);
  return result;
}

void read_paths(const TableReader& table, Drawn& drawn) {
  const TableReader::Keys meeting = scene::keys(
      "range_m size_px azimuth_deg elevation_deg speed_mps heading_deg "
      "climb_deg bank_deg");
  table.exclude("encounter", {"seen"});
  table.exclude("encounter", meeting);
  table.exclude("seen", meeting);
  drawn.approach = drawn_approach_in(table);
  drawn.seen = drawn_seen_in(table);
  read_place(table, drawn.place);
  drawn.speed_mps = range_or_type(table, "speed_mps", scene::kSpeed);
  drawn.climb_deg = range_or_type(table, "climb_deg", scene::kPitch);
  drawn.bank_deg = range_or_type(
      table, "bank_deg", {"[low, high] in degrees from -85 to 85, or \"type\"", -85, 85});
  drawn.bank_suits_type = table.has("bank_deg") && !drawn.bank_deg;
}

// True where the scenes of a background may have a value of that camera key.
bool may_have(const Background& background, std::initializer_list<const char*> names) {
  const scene::CameraModel& model = background.camera_model;
  return background.realism.automatic || background.realism.file ||
         std::ranges::any_of(names, [&](const char* name) {
           const auto& member = scene::camera_key(name)->member;
           return (model.*std::get<scene::CameraKey::Number>(member)).has_value() ||
                  std::ranges::count(model.automatic, name) > 0;
         });
}

// A factor needs something to multiply on every background.
void expect_value(const TableReader& table,
                  const char* key,
                  std::initializer_list<const char*> names,
                  const Drawn& drawn,
                  const Catalogue& catalogue) {
  if (!table.has(key)) return;
  for (const std::size_t i : drawn.backgrounds)
    if (!may_have(catalogue.backgrounds[i], names))
      table.fail(key,
                 fmt::format("{} is a factor on {}, which background '{}' has not; expected a "
                             "number or \"auto\" there, or realism",
                             key,
                             *names.begin(),
                             catalogue.backgrounds[i].name));
}

void read_weather(const TableReader& rule, const Catalogue& catalogue, Drawn& drawn) {
  if (!rule.has("weather")) return;
  const std::vector<std::string> names = scene::weather_names();
  const TableReader table = rule.table("weather", {names.begin(), names.end()});
  if (catalogue.composite.method == scene::CompositeMethod::kChromaKey)
    throw Error("[random.weather] is not for composite.method chroma-key; expected \"matte\"",
                table.where());
  DrawnWeather& weather = drawn.weather.emplace();
  weather.where = table.where();
  weather.visibility_m = number_in(table, scene::kVisibilityKey, scene::kVisibility);
  for (std::size_t i = 0; i < scene::kWeatherKeys.size(); ++i)
    weather.factors[i] =
        number_in(table, scene::kWeatherKeys[i].name, scene::kWeatherKeys[i].limits);
  expect_value(table, "blur", {"optics.point_spread_px"}, drawn, catalogue);
  expect_value(table, "noise", {"sensor.noise_gain", "sensor.noise_floor"}, drawn, catalogue);
}

Drawn drawn_from(const TableReader& table, const Catalogue& catalogue) {
  Drawn drawn{numbered_rule(table, catalogue, "r{index}", 90, kMaxDrawnFrames)};
  read_paths(table, drawn);
  read_intruders(table, catalogue.negatives, drawn);
  read_start(table, catalogue, drawn);
  read_weather(table, catalogue, drawn);
  drawn.daytime = daytime_from(table);
  drawn.sun_azimuth_deg = maybe_range(table, "sun_azimuth_deg", scene::kTurn);
  drawn.sun_elevation_deg = maybe_range(table, "sun_elevation_deg", scene::kPitch);
  return drawn;
}

}  // namespace

NumberedRule numbered_rule(const TableReader& table,
                           const Catalogue& catalogue,
                           const char* usual_name,
                           std::int64_t usual_frames,
                           std::int64_t most_frames) {
  return {.name = index_pattern(table, usual_name),
          .where = table.where(),
          .count = table.whole("count", 1, kMostSequences).value_or(1),
          .frame_count = table.whole("frame_count", 1, most_frames).value_or(usual_frames),
          .backgrounds = places_of(table, "backgrounds", catalogue.backgrounds, "background"),
          .types = types_in(table)};
}

void read_place(const TableReader& table, MeetingPlace& place) {
  table.exclude("size_px", {"range_m"});
  read_range(table, "range_m", scene::kRangeToAircraft, place.range_m);
  place.size_px = maybe_range(table, "size_px", scene::kApparentSize);
  read_range(table, "azimuth_deg", scene::kTurn, place.azimuth_deg);
  read_range(table, "elevation_deg", scene::kPitch, place.elevation_deg);
  read_range(table, "heading_deg", scene::kTurn, place.heading_deg);
}

std::vector<Drawn> drawn_rules(const TableReader& root, const Catalogue& catalogue) {
  std::vector<Drawn> result;
  for (const TableReader& table : root.tables(
           "random",
           scene::keys("name count frame_count backgrounds aircraft range_m size_px azimuth_deg "
                       "elevation_deg speed_mps heading_deg climb_deg bank_deg sun_azimuth_deg "
                       "sun_elevation_deg time_of_day_h latitude_deg day_of_year negatives "
                       "intruders start encounter seen weather")))
    result.push_back(drawn_from(table, catalogue));
  return result;
}

double DrawnNumber::draw(Random& random) const { return at(random.uniform()); }

double DrawnNumber::at(double share) const {
  return any_of.empty() ? low + share * (high - low) : one_at(share, any_of);
}

double DrawnNumber::at_in_logarithm(double share) const {
  return any_of.empty() ? low * std::pow(high / low, share) : one_at(share, any_of);
}

scene::Encounter DrawnApproach::draw(Random random, double usual_speed_mps) const {
  const auto maybe = [&](const std::optional<DrawnNumber>& number) {
    return number ? std::optional(number->draw(random)) : std::nullopt;
  };
  return {.cpa_time_s = maybe(cpa_time_s).value_or(0),
          .cpa_right_m = maybe(cpa_right_m),
          .cpa_ahead_m = maybe(cpa_ahead_m),
          .cpa_above_m = cpa_above_m.draw(random),
          .course_deg = course_deg.draw(random),
          .speed_mps = maybe(speed_mps).value_or(usual_speed_mps),
          .climb_mps = climb_mps.draw(random),
          .turn_rate_dps = turn_rate_dps.draw(random),
          .where = where};
}

scene::Seen DrawnSeen::draw(Random& random) const {
  scene::Seen seen{.time_s = time_s.draw(random), .where = where};
  seen.pixel.x() = x_px.draw(random);
  seen.pixel.y() = y_px.draw(random);
  if (range_m) seen.range_m = range_m->at_in_logarithm(random.uniform());
  if (width_px) seen.width_px = width_px->at_in_logarithm(random.uniform());
  return seen;
}

}  // namespace airtruth::catalogue
