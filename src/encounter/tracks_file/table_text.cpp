// SPDX-License-Identifier: Apache-2.0
#include "encounter/tracks_file/table_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/text.h"
#include "foundation/geometry/transform.h"
#include "foundation/geometry/units.h"

namespace airtruth::tracks_file {
namespace {

constexpr std::string_view kBlanks = " \t\r";
// Largest length of an aircraft's name: a choice.
constexpr std::size_t kMaxNameBytes = 60;

void split_row(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  if (line.find(',') == line.npos) {
    for (std::size_t at = line.find_first_not_of(kBlanks); at != line.npos;) {
      const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
      cells.push_back(line.substr(at, end - at));
      at = line.find_first_not_of(kBlanks, end);
    }
    return;
  }
  for (bool more = true; more;) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    more = comma != line.npos;
    if (more) line.remove_prefix(comma + 1);
  }
  if (cells.back().empty()) cells.pop_back();
}

}  // namespace

Lines::Lines(std::string_view text, std::string file)
    : rest_(without_mark(text)), file_(std::move(file)) {}

bool Lines::next() {
  while (!rest_.empty()) {
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_ = end == rest_.npos ? std::string_view() : rest_.substr(end + 1);
    ++number_;
    line_ = trimmed(line.substr(0, line.find('#')));
    if (line_.empty()) continue;
    split_row(line_, cells_);
    return true;
  }
  return false;
}

double number_in(std::string_view cell, std::string_view name, const Where& where) {
  const auto value = number_from_text<double>(cell);
  if (!value || !(std::abs(*value) <= kMaxNumber))
    throw Error(
        fmt::format("{} is '{}'; expected a number up to 1e9 in size", name, cell.substr(0, 40)),
        where);
  return *value;
}

std::string aircraft_name_in(std::string_view cell, const Where& where) {
  std::string name(cell);
  std::ranges::replace(name, ' ', '_');
  const bool is_plain = std::ranges::all_of(
      name, [](char c) { return c > ' ' && c < 0x7f && c != '"' && c != '\'' && c != '='; });
  if (name.empty() || name.size() > kMaxNameBytes || !is_plain)
    throw Error(
        fmt::format("the aircraft is named '{}'; expected 1 to {} letters, digits and signs",
                    is_plain ? name.substr(0, kMaxNameBytes) : "?",
                    kMaxNameBytes),
        where);
  return name;
}

namespace {

// A unit by its names, of which messages use the first.
struct Unit {
  std::string_view names;
  Dimension dimension;
  double factor;
};

constexpr auto kUnits = std::to_array<Unit>({
    {"none", Dimension::kNone, 1},
    {"unitless unspecified", Dimension::kNone, 1},
    {"m meter metre", Dimension::kLength, 1},
    {"km", Dimension::kLength, 1000},
    {"ft feet foot", Dimension::kLength, kMetresOfFoot},
    {"nmi nm NM", Dimension::kLength, kMetresOfNauticalMile},
    {"deg degree", Dimension::kAngle, radians(1)},
    {"rad radian", Dimension::kAngle, 1},
    {"m/s mps", Dimension::kSpeed, 1},
    {"km/h kph", Dimension::kSpeed, 1 / 3.6},
    {"knot kn kt kts", Dimension::kSpeed, kMpsOfKnot},
    {"fpm ft/min", Dimension::kSpeed, kMpsOfFootPerMinute},
    {"ftps fps ft/s", Dimension::kSpeed, kMetresOfFoot},
    {"s sec", Dimension::kTime, 1},
    {"ms", Dimension::kTime, 1e-3},
    {"min", Dimension::kTime, 60},
    {"h hour", Dimension::kTime, 3600},
});

std::string_view without_brackets(std::string_view word) {
  if (word.size() >= 2 && word.front() == '[' && word.back() == ']')
    return word.substr(1, word.size() - 2);
  return word;
}

}  // namespace

bool begins_with_column(std::string_view text, std::string_view column) {
  Lines lines(text, "");
  return lines.next() && std::ranges::find(lines.cells(), column) != lines.cells().end();
}

bool is_among(std::string_view word, std::string_view words) {
  std::vector<std::string_view> cells;
  split_row(words, cells);
  return std::ranges::find(cells, word) != cells.end();
}

std::optional<double> factor_of(std::string_view unit, Dimension dimension) {
  const std::string_view name = without_brackets(unit);
  for (const Unit& known : kUnits)
    if (known.dimension == dimension && is_among(name, known.names)) return known.factor;
  return std::nullopt;
}

bool is_unit_word(std::string_view word) {
  return without_brackets(word) != word ||
         std::ranges::any_of(kUnits, [&](const Unit& unit) { return is_among(word, unit.names); });
}

std::string units_of(Dimension dimension) {
  std::vector<std::string_view> names;
  for (const Unit& unit : kUnits)
    if (unit.dimension == dimension) names.push_back(unit.names.substr(0, unit.names.find(' ')));
  return fmt::format("{}", fmt::join(names, ", "));
}

void TrackBuilder::add(const std::string& name,
                       double time_s,
                       const Vector3& position_ned_m,
                       const Vector3* velocity_ned_mps,
                       const Where& where) {
  std::vector<track::Track>& aircraft = encounter_.aircraft;
  if (last_ >= aircraft.size() || aircraft[last_].name != name) {
    const auto [place, is_new] = places_.try_emplace(name, aircraft.size());
    if (is_new && aircraft.size() == kMaxAircraft)
      throw Error(fmt::format("'{}' is aircraft {} of the encounter; expected up to {}",
                              name,
                              aircraft.size() + 1,
                              kMaxAircraft),
                  where);
    if (is_new) aircraft.push_back({name, {}, {}, {}});
    last_ = place->second;
  }
  track::Track& track = aircraft[last_];
  if (!track.times_s.empty() && !(time_s > track.times_s.back()))
    throw Error(fmt::format("the time of '{}' is {} s after {} s; expected times that increase",
                            name,
                            time_s,
                            track.times_s.back()),
                where);
  track.times_s.push_back(time_s);
  track.positions_ned_m.push_back(position_ned_m);
  if (velocity_ned_mps != nullptr) track.velocities_ned_mps.push_back(*velocity_ned_mps);
}

track::Encounter TrackBuilder::take() {
  places_.clear();
  last_ = 0;
  return std::exchange(encounter_, track::Encounter{});
}

}  // namespace airtruth::tracks_file
