// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "encounter/track/track.h"
#include "encounter/tracks_file/formats.h"
#include "encounter/tracks_file/table_text.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"
#include "foundation/geometry/units.h"

// The files of comma-separated values: airtruth's own encounters and MIT-LL's tracks.
namespace airtruth::tracks_file {
namespace {

enum EncounterColumn {
  kEncounterColumn,
  kAircraftColumn,
  kTimeColumn,
  kNorthColumn,
  kEastColumn,
  kDownColumn,
  kNorthSpeedColumn,
  kEastSpeedColumn,
  kDownSpeedColumn,
  kWeightColumn,
  kEncounterColumns
};
const std::vector<std::string> kEncounterColumnNames =
    words_in("encounter aircraft time_s north_m east_m down_m north_mps east_mps down_mps weight");

using Places = std::vector<std::size_t>;

Places columns_of(const std::vector<std::string_view>& headings, const Where& where) {
  const Places places =
      airtruth::places_of(kEncounterColumnNames, {headings.begin(), headings.end()}, where);
  const auto is_there = [&](EncounterColumn column) { return places[column] != kNoColumn; };
  const bool has_velocity =
      is_there(kNorthSpeedColumn) || is_there(kEastSpeedColumn) || is_there(kDownSpeedColumn);
  for (std::size_t column = 0; column < kEncounterColumns; ++column) {
    const bool is_needed = column <= kDownColumn || (column <= kDownSpeedColumn && has_velocity);
    if (is_needed && places[column] == kNoColumn)
      throw Error(fmt::format("has no column '{}'; expected it in the header",
                              kEncounterColumnNames[column]),
                  where);
  }
  return places;
}

class EncounterRows {
 public:
  explicit EncounterRows(const Places& places) : places_(places) {}

  void add(const std::vector<std::string_view>& cells, const Where& where) {
    const auto value = [&](EncounterColumn column) {
      return number_in(cells[places_[column]], kEncounterColumnNames[column], where);
    };
    const double number = value(kEncounterColumn);
    if (number < 0 || number != std::floor(number))
      throw Error(fmt::format("encounter is {}; expected a whole number from 0", number), where);
    if (builder_.is_empty() || number != number_) begin(number, where);
    if (places_[kWeightColumn] != kNoColumn) set_weight(value(kWeightColumn), where);
    const std::string name = aircraft_name_in(cells[places_[kAircraftColumn]], where);
    const double time_s = value(kTimeColumn);
    const Vector3 position(value(kNorthColumn), value(kEastColumn), value(kDownColumn));
    if (places_[kNorthSpeedColumn] == kNoColumn) {
      builder_.add(name, time_s, position, nullptr, where);
    } else {
      const Vector3 velocity(
          value(kNorthSpeedColumn), value(kEastSpeedColumn), value(kDownSpeedColumn));
      builder_.add(name, time_s, position, &velocity, where);
    }
  }

  std::vector<track::Encounter> take() {
    end();
    return std::move(encounters_);
  }

 private:
  void begin(double number, const Where& where) {
    end();
    if (!seen_.insert(number).second)
      throw Error(
          fmt::format("encounter {} goes on after another; expected its rows together", number),
          where);
    number_ = number;
    weight_ = 0;
  }
  void end() {
    if (builder_.is_empty()) return;
    encounters_.push_back(builder_.take());
    if (places_[kWeightColumn] != kNoColumn) encounters_.back().weight = weight_;
  }
  void set_weight(double weight, const Where& where) {
    if (!(weight > 0))
      throw Error(fmt::format("weight is {}; expected a positive number", weight), where);
    if (weight_ > 0 && weight != weight_)
      throw Error(
          fmt::format(
              "weight is {} after {}; expected one weight for an encounter", weight, weight_),
          where);
    weight_ = weight;
  }

  const Places& places_;
  TrackBuilder builder_;
  std::set<double> seen_;
  double number_ = 0;
  double weight_ = 0;
  std::vector<track::Encounter> encounters_;
};

}  // namespace

std::vector<track::Encounter> parse_encounter_csv(std::string_view text,
                                                  const std::filesystem::path& file) {
  Lines lines(text, file.string());
  if (!lines.next()) throw Error("is empty; expected a header and rows", {file.string()});
  const Places places = columns_of(lines.cells(), lines.where());
  const std::size_t columns = lines.cells().size();
  EncounterRows rows(places);
  while (lines.next()) {
    if (lines.cells().size() != columns)
      throw Error(
          fmt::format(
              "has {} cells for {} columns; expected one each", lines.cells().size(), columns),
          lines.where());
    rows.add(lines.cells(), lines.where());
  }
  std::vector<track::Encounter> encounters = rows.take();
  if (encounters.empty())
    throw Error("has no rows; expected one for each aircraft and time", lines.where());
  return encounters;
}

std::string encounter_csv_head() {
  return fmt::format("{}\n", fmt::join(kEncounterColumnNames, ","));
}

std::string encounter_csv_rows(const track::Encounter& encounter, std::uint64_t number) {
  std::string text;
  for (const track::Track& track : encounter.aircraft) {
    const std::vector<Vector3> velocities = track::velocities_of(track);
    for (std::size_t i = 0; i < track.size(); ++i) {
      const Vector3 p = plain(track.positions_ned_m[i]);
      const Vector3 v = plain(velocities[i]);
      fmt::format_to(std::back_inserter(text),
                     "{},{},{},{},{},{}\n",
                     number,
                     track.name,
                     track.times_s[i],
                     fmt::join(p, ","),
                     fmt::join(v, ","),
                     encounter.weight);
    }
  }
  return text;
}

namespace {

constexpr std::array<std::string_view, 4> kColumnNames = {"time_s", "x_ft", "y_ft", "z_ft"};

std::array<std::size_t, kColumnNames.size()> places_of(
    const std::vector<std::string_view>& headings, const Where& where) {
  std::array<std::size_t, kColumnNames.size()> places{};
  for (std::size_t i = 0; i < kColumnNames.size(); ++i) {
    const auto found = std::ranges::find(headings, kColumnNames[i]);
    if (found == headings.end() || headings.size() != kColumnNames.size())
      throw Error(fmt::format("the header is '{}'; expected {}",
                              fmt::format("{}", fmt::join(headings, ",")).substr(0, 80),
                              fmt::join(kColumnNames, ",")),
                  where);
    places[i] = static_cast<std::size_t>(found - headings.begin());
  }
  return places;
}

}  // namespace

track::Encounter parse_track_csv(std::string_view text, const std::filesystem::path& file) {
  Lines lines(text, file.string());
  if (!lines.next()) throw Error("is empty; expected a header and rows", {file.string()});
  const auto places = places_of(lines.cells(), lines.where());
  TrackBuilder builder;
  while (lines.next()) {
    const std::vector<std::string_view>& cells = lines.cells();
    if (cells.size() != kColumnNames.size())
      throw Error(fmt::format("has {} cells; expected {}", cells.size(), kColumnNames.size()),
                  lines.where());
    std::array<double, kColumnNames.size()> values{};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = number_in(cells[places[i]], kColumnNames[i], lines.where());
    const Vector3 position_ned_ft(values[1], values[2], -values[3]);
    builder.add("track", values[0], kMetresOfFoot * position_ned_ft, nullptr, lines.where());
  }
  if (builder.is_empty()) throw Error("has no rows; expected one for each second", lines.where());
  return builder.take();
}

}  // namespace airtruth::tracks_file
