// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/drawn_path.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"

namespace airtruth::dataset {
namespace {

using scene::TableReader;

double one_of(Random& random, const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(random.uniform() * count))];
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
  } else if (table.is_array(key)) {
    const auto range = table.tuple(key, {limits, limits});
    drawn.low = (*range)[0];
    drawn.high = (*range)[1];
    if (drawn.low > drawn.high) table.fail(key, fmt::format("{} falls; expected [low, high]", key));
  } else {
    drawn.low = drawn.high = *table.number(key, limits);
  }
  return drawn;
}

DrawnNumber fixed(double value) { return {value, value, {}}; }

void read_pixel(const TableReader& table, DrawnSeen& seen) {
  table.exclude("pixel", {"x_px", "y_px"});
  const auto pixel = table.tuple("pixel", {scene::kPixel, scene::kPixel});
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

}  // namespace

double DrawnNumber::least() const {
  return any_of.empty() ? low : *std::min_element(any_of.begin(), any_of.end());
}

double DrawnNumber::greatest() const {
  return any_of.empty() ? high : *std::max_element(any_of.begin(), any_of.end());
}

double DrawnNumber::draw(Random& random) const {
  return any_of.empty() ? random.uniform(low, high) : one_of(random, any_of);
}

double DrawnNumber::draw_in_logarithm(Random& random) const {
  return any_of.empty() ? low * std::pow(high / low, random.uniform()) : one_of(random, any_of);
}

scene::Encounter DrawnApproach::draw(Random random, double usual_speed_mps) const {
  const auto maybe = [&](const std::optional<DrawnNumber>& number) {
    return number ? std::optional(number->draw(random)) : std::nullopt;
  };
  scene::Encounter encounter;
  encounter.cpa_time_s = maybe(cpa_time_s).value_or(0);
  encounter.cpa_right_m = maybe(cpa_right_m);
  encounter.cpa_ahead_m = maybe(cpa_ahead_m);
  encounter.cpa_above_m = cpa_above_m.draw(random);
  encounter.course_deg = course_deg.draw(random);
  encounter.speed_mps = maybe(speed_mps).value_or(usual_speed_mps);
  encounter.climb_mps = climb_mps.draw(random);
  encounter.turn_rate_dps = turn_rate_dps.draw(random);
  encounter.where = where;
  return encounter;
}

scene::Seen DrawnSeen::draw(Random& random) const {
  scene::Seen seen;
  seen.time_s = time_s.draw(random);
  seen.pixel.x() = x_px.draw(random);
  seen.pixel.y() = y_px.draw(random);
  if (range_m) seen.range_m = range_m->draw_in_logarithm(random);
  if (width_px) seen.width_px = width_px->draw_in_logarithm(random);
  seen.where = where;
  return seen;
}

std::optional<DrawnApproach> drawn_approach_in(const TableReader& rule) {
  if (!rule.has("encounter")) return std::nullopt;
  const TableReader table = rule.table("encounter",
                                       {"cpa_time_s",
                                        "cpa_right_m",
                                        "cpa_above_m",
                                        "cpa_ahead_m",
                                        "course_deg",
                                        "speed_mps",
                                        "climb_mps",
                                        "turn_rate_dps"});
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
      std::max(std::abs(drawn.climb_mps.least()), std::abs(drawn.climb_mps.greatest()));
  if (drawn.speed_mps && steepest_mps > drawn.speed_mps->least())
    table.fail("climb_mps",
               fmt::format("climb_mps reaches {} at a speed_mps of {}; expected no more than the "
                           "speed",
                           scene::shown(steepest_mps),
                           scene::shown(drawn.speed_mps->least())));
  return drawn;
}

std::vector<DrawnSeen> drawn_seen_in(const TableReader& rule) {
  std::vector<DrawnSeen> result;
  for (const TableReader& table :
       rule.tables("seen", {"time_s", "pixel", "x_px", "y_px", "range_m", "width_px"})) {
    result.push_back(seen_from(table));
    if (result.size() < 2) continue;
    const DrawnSeen& before = result[result.size() - 2];
    if (!(result.back().time_s.least() > before.time_s.greatest()))
      table.fail("time_s",
                 fmt::format("time_s may be {}, not after the {} of the [[random.seen]] before; "
                             "expected later times",
                             scene::shown(result.back().time_s.least()),
                             scene::shown(before.time_s.greatest())));
  }
  if (result.size() == 1)
    throw Error("[[random.seen]] is alone; expected at least two of them", result[0].where);
  return result;
}

}  // namespace airtruth::dataset
