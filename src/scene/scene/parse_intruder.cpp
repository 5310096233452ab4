// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "aircraft/wrapper/reader.h"
#include "scene/scene/tables.h"

namespace airtruth::scene {
namespace {

double required(const TableReader& table, const char* key, const Limits& limits, const char* what) {
  if (const auto value = table.number(key, limits)) return *value;
  throw Error(fmt::format("[encounter] has no {}; expected {}", key, what), table.where());
}

Seen seen_from(const TableReader& table) {
  Seen seen;
  seen.where = table.where();
  const auto time_s = table.number("time_s", kTime);
  const auto pixel = table.tuple<Pixel>("pixel", kPixel);
  if (!time_s || !pixel)
    throw Error(fmt::format("[[seen]] has no {}; expected time_s, pixel = [x, y], and "
                            "range_m or width_px",
                            time_s ? "pixel" : "time_s"),
                table.where());
  seen.time_s = *time_s;
  seen.pixel = *pixel;
  table.exclude("range_m", {"width_px"});
  seen.range_m = table.number("range_m", kRangeToAircraft);
  seen.width_px = table.number("width_px", kApparentSize);
  if (!seen.range_m && !seen.width_px)
    throw Error("[[seen]] has no range_m and no width_px; expected one of them", table.where());
  return seen;
}

}  // namespace

Encounter encounter_in(const TableReader& parent) {
  const TableReader table = parent.table("encounter", kEncounterKeys);
  Encounter encounter;
  encounter.where = table.where();
  encounter.cpa_time_s =
      required(table, "cpa_time_s", kTime, "the time of the closest approach, in seconds");
  encounter.course_deg = required(
      table, "course_deg", kTurn, "the course from the own course: 180 head-on, 90 from the left");
  encounter.speed_mps = required(table, "speed_mps", kSpeed, "the speed in metres a second");
  encounter.cpa_right_m = table.number("cpa_right_m", kMiss);
  encounter.cpa_ahead_m = table.number("cpa_ahead_m", kMiss);
  encounter.cpa_above_m = table.number("cpa_above_m", kMiss).value_or(0);
  encounter.climb_mps = table.number("climb_mps", kClimb).value_or(0);
  encounter.turn_rate_dps = table.number("turn_rate_dps", kTurnRate).value_or(0);
  if (std::abs(encounter.climb_mps) > encounter.speed_mps)
    table.fail("climb_mps",
               fmt::format("climb_mps is {} at a speed_mps of {}; expected no more than the speed",
                           encounter.climb_mps,
                           encounter.speed_mps));
  return encounter;
}

std::vector<Seen> seen_in(const TableReader& parent) {
  std::vector<Seen> result;
  if (!parent.has("seen")) return result;
  for (const TableReader& table :
       parent.tables("seen", {"time_s", "pixel", "range_m", "width_px"})) {
    result.push_back(seen_from(table));
    if (result.size() < 2) continue;
    const Seen& before = result[result.size() - 2];
    if (!(result.back().time_s > before.time_s))
      table.fail("time_s",
                 fmt::format("time_s is {}, not after the {} of the [[seen]] before; "
                             "expected increasing times",
                             result.back().time_s,
                             before.time_s));
  }
  if (result.size() == 1)
    throw Error("[[seen]] is alone; expected at least two of them", result[0].where);
  return result;
}

namespace {

void read_axes(const TableReader& table, Intruder& intruder) {
  const std::vector<std::string> axes = {"x", "-x", "y", "-y", "z", "-z"};
  intruder.model_forward = table.choice("model_forward", axes);
  intruder.model_up = table.choice("model_up", axes);
  intruder.model_scale = table.number("model_scale", kModelScale);
  intruder.catalogue_scale = table.number("catalogue_scale", kModelScale);
  intruder.spin_time_s = table.number("spin_time_s", kTime).value_or(0);
  if (intruder.model_forward && intruder.model_up &&
      intruder.model_forward->back() == intruder.model_up->back())
    table.fail("model_up",
               fmt::format("model_up is '{}', along model_forward '{}'; expected another axis",
                           *intruder.model_up,
                           *intruder.model_forward));
}

void check_waypoints(const TableReader& table, const std::vector<Vector3>& points) {
  if (points.size() < 2)
    table.fail("waypoints_ned_m",
               fmt::format("waypoints_ned_m has {} {}; expected at least two",
                           points.size(),
                           points.size() == 1 ? "point" : "points"));
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i] == points[i - 1])
      throw Error(
          fmt::format("waypoints_ned_m[{}] is the same point as the one before; expected another",
                      i),
          table.where("waypoints_ned_m", i));
}

void check_times(const TableReader& table,
                 const std::vector<double>& times_s,
                 std::size_t waypoints) {
  if (times_s.size() != waypoints)
    table.fail("times_s",
               fmt::format("times_s has {} numbers; expected one for each of the {} waypoints",
                           times_s.size(),
                           waypoints));
  for (std::size_t i = 1; i < times_s.size(); ++i)
    if (times_s[i] <= times_s[i - 1])
      throw Error(fmt::format("times_s[{}] is {}, not after {}; expected increasing times",
                              i,
                              times_s[i],
                              times_s[i - 1]),
                  table.where("times_s", i));
}

Intruder intruder_from(const TableReader& table) {
  Intruder intruder;
  intruder.where = table.where();
  intruder.id = table.file_name("id").value_or("");
  intruder.aircraft = aircraft_in(table);
  read_axes(table, intruder);
  read_path(table, "[[intruder]]", intruder);
  read_attitude(table, intruder);
  return intruder;
}

}  // namespace

void read_path(const TableReader& table, const char* title, Intruder& intruder) {
  table.exclude("path_file", {"waypoints_ned_m", "speed_mps", "times_s"});
  table.exclude("encounter",
                {"seen", "waypoints_ned_m", "speed_mps", "times_s", "path_file", "start_s"});
  table.exclude("seen", {"waypoints_ned_m", "speed_mps", "times_s", "path_file", "start_s"});
  if (table.has("encounter")) intruder.encounter = encounter_in(table);
  intruder.seen = seen_in(table);
  if (intruder.encounter || !intruder.seen.empty()) return;
  table.exclude("speed_mps", {"times_s"});
  intruder.start_s = table.number("start_s", kTime).value_or(0);
  intruder.path_file = table.path("path_file");
  if (intruder.path_file) return;
  const auto points = table.points("waypoints_ned_m", kPosition);
  if (!points)
    throw Error(std::string(title) +
                    " has no path; expected waypoints_ned_m with speed_mps or times_s, path_file, "
                    "encounter or seen",
                table.where());
  check_waypoints(table, *points);
  intruder.waypoints_ned_m = *points;
  intruder.speed_mps = table.number("speed_mps", kSpeed);
  intruder.times_s = table.numbers("times_s", kTime).value_or(std::vector<double>{});
  if (table.has("times_s")) check_times(table, intruder.times_s, points->size());
  if (!intruder.speed_mps && !table.has("times_s"))
    throw Error(
        std::string(title) + " has waypoints_ned_m alone; expected speed_mps or times_s with them",
        table.where());
}

void read_attitude(const TableReader& table, Intruder& intruder) {
  intruder.yaw_deg = table.number("yaw_deg", kTurn);
  intruder.pitch_deg = table.number("pitch_deg", kPitch);
  intruder.roll_deg = table.number("roll_deg", kTurn);
}

std::vector<Intruder> intruders_from(const TableReader& root) {
  std::vector<Intruder> result;
  std::map<std::string, int> line_of_id;
  for (const TableReader& table :
       root.tables("intruder",
                   keys("id aircraft model_forward model_up model_scale catalogue_scale "
                        "spin_time_s waypoints_ned_m speed_mps times_s path_file encounter seen "
                        "start_s yaw_deg pitch_deg roll_deg"))) {
    Intruder intruder = intruder_from(table);
    if (intruder.id.empty()) intruder.id = fmt::format("intruder-{}", result.size() + 1);
    const auto [before, is_new] = line_of_id.emplace(intruder.id, table.where("id").line);
    if (!is_new)
      table.fail("id",
                 fmt::format("id '{}' is taken by the intruder at line {}; expected another",
                             intruder.id,
                             before->second));
    result.push_back(std::move(intruder));
  }
  return result;
}

std::string aircraft_in(const TableReader& table) {
  const auto name = table.text("aircraft");
  if (!name)
    throw Error("has no aircraft; expected a name (see `airtruth aircraft list`) or a model file",
                table.where());
  return wrapper::is_model_file(*name) ? table.path("aircraft")->string() : *name;
}

}  // namespace airtruth::scene
