// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/parse_encounter.h"

#include <cmath>

#include <fmt/format.h>

namespace airtruth::scene {
namespace {

double required(const TableReader& table, const char* key, const Limits& limits, const char* what) {
  if (const auto value = table.number(key, limits)) return *value;
  throw Error(fmt::format("[intruder.encounter] has no {}; expected {}", key, what), table.where());
}

Seen seen_from(const TableReader& table) {
  Seen seen;
  seen.where = table.where();
  const auto time_s = table.number("time_s", kTime);
  const auto pixel = table.tuple("pixel", {kPixel, kPixel});
  if (!time_s || !pixel)
    throw Error(fmt::format("[[intruder.seen]] has no {}; expected time_s, pixel = [x, y], and "
                            "range_m or width_px",
                            time_s ? "pixel" : "time_s"),
                table.where());
  seen.time_s = *time_s;
  seen.pixel = {(*pixel)[0], (*pixel)[1]};
  table.exclude("range_m", {"width_px"});
  seen.range_m = table.number("range_m", kRangeToAircraft);
  seen.width_px = table.number("width_px", kApparentSize);
  if (!seen.range_m && !seen.width_px)
    throw Error("[[intruder.seen]] has no range_m and no width_px; expected one of them",
                table.where());
  return seen;
}

}  // namespace

Encounter encounter_in(const TableReader& parent) {
  const TableReader table = parent.table("encounter",
                                         {"cpa_time_s",
                                          "cpa_right_m",
                                          "cpa_above_m",
                                          "cpa_ahead_m",
                                          "course_deg",
                                          "speed_mps",
                                          "climb_mps",
                                          "turn_rate_dps"});
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
                           shown(encounter.climb_mps),
                           shown(encounter.speed_mps)));
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
                 fmt::format("time_s is {}, not after the {} of the [[intruder.seen]] before; "
                             "expected increasing times",
                             shown(result.back().time_s),
                             shown(before.time_s)));
  }
  if (result.size() == 1)
    throw Error("[[intruder.seen]] is alone; expected at least two of them", result[0].where);
  return result;
}

}  // namespace airtruth::scene
