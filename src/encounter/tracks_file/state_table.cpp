// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "encounter/track/track.h"
#include "encounter/tracks_file/formats.h"
#include "encounter/tracks_file/table_text.h"
#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/geometry/units.h"

namespace airtruth::tracks_file {
namespace {

enum Column {
  kName,
  kTime,
  kClock,
  kEast,
  kNorth,
  kAltitude,
  kLatitude,
  kLongitude,
  kCourse,
  kGroundSpeed,
  kAirspeed,
  kClimb,
  kEastSpeed,
  kNorthSpeed,
  kUpSpeed,
  kColumns
};

// Headings in lower case that mean one column, and what the column holds.
struct Heading {
  std::string_view words;
  Column column;
  Dimension dimension;
};

constexpr auto kHeadings = std::to_array<Heading>({
    {"name aircraft id", kName, Dimension::kNone},
    {"time tm st", kTime, Dimension::kTime},
    {"clock", kClock, Dimension::kNone},
    {"sx east", kEast, Dimension::kLength},
    {"sy north", kNorth, Dimension::kLength},
    {"sz alt altitude", kAltitude, Dimension::kLength},
    {"lat latitude", kLatitude, Dimension::kAngle},
    {"lon long longitude", kLongitude, Dimension::kAngle},
    {"trk track hdg", kCourse, Dimension::kAngle},
    {"gs groundspeed groundspd", kGroundSpeed, Dimension::kSpeed},
    {"speed", kAirspeed, Dimension::kSpeed},
    {"vs verticalspeed hdot dh", kClimb, Dimension::kSpeed},
    {"vx", kEastSpeed, Dimension::kSpeed},
    {"vy", kNorthSpeed, Dimension::kSpeed},
    {"vz", kUpSpeed, Dimension::kSpeed},
});

constexpr std::size_t kAbsent = ~std::size_t{0};

// Where the columns stand, and the factors of their units.
struct Layout {
  std::array<std::size_t, kColumns> place{};
  std::array<double, kColumns> factor{};
  std::array<std::string, kColumns> word;
  std::size_t cells = 0;

  bool has(Column column) const { return place[column] != kAbsent; }
};

// The columns that `layout` must have; the Error names what is missing.
void require_columns(const Layout& layout, const Where& where) {
  const auto all = [&](std::initializer_list<Column> columns) {
    return std::ranges::all_of(columns, [&](Column c) { return layout.has(c); });
  };
  const auto require = [&](bool is_there, const char* what) {
    if (!is_there) throw Error(fmt::format("the headings lack {}", what), where);
  };
  require(layout.has(kName), "the aircraft; expected a column 'name'");
  require(layout.has(kTime) != layout.has(kClock), "the time; expected one of 'time' and 'clock'");
  require(all({kEast, kNorth}) != all({kLatitude, kLongitude}),
          "the position; expected one of 'sx sy', 'lat lon' and 'east north'");
  require(layout.has(kAltitude), "the altitude; expected 'sz' or 'alt'");
  require(all({kEastSpeed, kNorthSpeed, kUpSpeed}) !=
              (all({kCourse, kClimb}) && layout.has(kGroundSpeed) != layout.has(kAirspeed)),
          "the velocity; expected one of 'trk gs vs', 'vx vy vz' and 'hdg speed dh'");
}

Layout layout_of(const std::vector<std::string_view>& headings, const Where& where) {
  Layout layout;
  layout.place.fill(kAbsent);
  layout.cells = headings.size();
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const std::string word = lower_case(headings[i]);
    const auto known = std::ranges::find_if(
        kHeadings, [&](const Heading& heading) { return is_among(word, heading.words); });
    if (known == kHeadings.end()) continue;  // a column of something else
    if (layout.has(known->column))
      throw Error(fmt::format("the headings hold '{}' and '{}' for the same; expected one",
                              layout.word[known->column],
                              word),
                  where);
    layout.place[known->column] = i;
    layout.word[known->column] = word;
  }
  require_columns(layout, where);
  return layout;
}

void take_units(Layout& layout, const std::vector<std::string_view>& units, const Where& where) {
  // A row of states has no word of a unit, but an aircraft may be named 'm'.
  const auto words = std::ranges::count_if(units, is_unit_word);
  if (2 * static_cast<std::size_t>(words) < units.size())
    throw Error(
        "has no units; expected a row of them below the headings, for example "
        "[none] [nmi] [nmi] [ft] [deg] [knot] [fpm] [s]",
        where);
  if (units.size() != layout.cells)
    throw Error(
        fmt::format("has {} units for {} headings; expected one each", units.size(), layout.cells),
        where);
  for (const Heading& heading : kHeadings) {
    if (!layout.has(heading.column)) continue;
    const std::string_view unit = units[layout.place[heading.column]];
    // The clock is no number of a unit; DAIDALUS names any.
    const auto factor =
        heading.column == kClock ? std::optional(1.0) : factor_of(unit, heading.dimension);
    if (!factor)
      throw Error(fmt::format("the unit of '{}' is {}; expected one of {}",
                              layout.word[heading.column],
                              unit.empty() ? "missing" : unit.substr(0, 40),
                              units_of(heading.dimension)),
                  where);
    layout.factor[heading.column] = *factor;
  }
}

// "hh:mm:ss.s", or seconds alone, as seconds.
double seconds_of_clock(std::string_view text, const Where& where) {
  double seconds = 0;
  for (bool more = true; more;) {
    const std::size_t colon = text.find(':');
    const double part = number_in(text.substr(0, colon), "clock", where);
    if (part < 0) throw Error("clock is negative; expected hh:mm:ss", where);
    seconds = 60 * seconds + part;
    more = colon != text.npos;
    if (more) text.remove_prefix(colon + 1);
  }
  if (!(seconds <= kMaxNumber)) throw Error("clock is too large; expected hh:mm:ss", where);
  return seconds;
}

class RowReader {
 public:
  explicit RowReader(const Layout& layout) : layout_(layout) {}

  void read(const std::vector<std::string_view>& cells, const Where& where, TrackBuilder& builder) {
    cells_ = &cells;
    where_ = where;
    if (cells.size() != layout_.cells)
      throw Error(
          fmt::format(
              "has {} cells for {} headings; expected one each", cells.size(), layout_.cells),
          where);
    const double time_s =
        layout_.has(kTime) ? value(kTime) : seconds_of_clock(cells[layout_.place[kClock]], where);
    Vector3 position(0, 0, -value(kAltitude));
    Vector3 velocity = velocity_mps();
    if (layout_.has(kLatitude))
      project(position, velocity);
    else
      position.head<2>() = Eigen::Vector2d(value(kNorth), value(kEast));
    builder.add(
        aircraft_name_in(cells[layout_.place[kName]], where), time_s, position, &velocity, where);
  }

 private:
  double value(Column column) const {
    return layout_.factor[column] *
           number_in((*cells_)[layout_.place[column]], layout_.word[column], where_);
  }

  // Sets north and east of the position, and turns the velocity into the same plane.
  void project(Vector3& position_m, Vector3& velocity_mps) {
    const double latitude = value(kLatitude);
    const double longitude = value(kLongitude);
    if (std::abs(latitude) > kPi / 2 || std::abs(longitude) > 2 * kPi)
      throw Error("the position is outside of 90 degrees of latitude and 360 of longitude", where_);
    if (!origin_) origin_ = {latitude, longitude};
    const double sin_0 = std::sin(origin_->first), cos_0 = std::cos(origin_->first);
    const double sin_here = std::sin(latitude), cos_here = std::cos(latitude);
    const double sin_turn = std::sin(longitude - origin_->second);
    const double cos_turn = std::cos(longitude - origin_->second);
    if (sin_0 * sin_here + cos_0 * cos_here * cos_turn < 0.5)
      throw Error("the position is more than 60 degrees from the first; expected an encounter",
                  where_);
    // The sphere on which a minute of arc is a nautical mile.
    constexpr double kEarthRadius_m = kMetresOfNauticalMile * 60 * 180 / kPi;
    position_m.x() = kEarthRadius_m * (cos_0 * sin_here - sin_0 * cos_here * cos_turn);
    position_m.y() = kEarthRadius_m * cos_here * sin_turn;
    const double north = velocity_mps.x(), east = velocity_mps.y();
    velocity_mps.x() =
        (cos_0 * cos_here + sin_0 * sin_here * cos_turn) * north + sin_0 * sin_turn * east;
    velocity_mps.y() = -sin_here * sin_turn * north + cos_turn * east;
  }

  Vector3 velocity_mps() const {
    if (layout_.has(kEastSpeed)) return {value(kNorthSpeed), value(kEastSpeed), -value(kUpSpeed)};
    const double climb = value(kClimb);
    double ground = value(layout_.has(kGroundSpeed) ? kGroundSpeed : kAirspeed);
    if (ground < 0)
      throw Error(fmt::format("the speed is {} m/s; expected no negative one", ground), where_);
    if (layout_.has(kAirspeed)) ground = std::sqrt(std::max(0.0, ground * ground - climb * climb));
    const double course = value(kCourse);
    return {ground * std::cos(course), ground * std::sin(course), -climb};
  }

  const Layout& layout_;
  const std::vector<std::string_view>* cells_ = nullptr;
  Where where_;
  std::optional<std::pair<double, double>> origin_;
};

// Goes to the next line that holds a row: DAIDALUS allows parameters, "name = value", before the
// headings.
bool next_row(Lines& lines) {
  while (lines.next())
    if (lines.line().find('=') == std::string_view::npos) return true;
  return false;
}

}  // namespace

track::Encounter parse_state_table(std::string_view text, const std::filesystem::path& file) {
  Lines lines(text, file.string());
  if (!next_row(lines)) throw Error("is empty; expected headings, units and rows", {file.string()});
  Layout layout = layout_of(lines.cells(), lines.where());
  if (!next_row(lines))
    throw Error("ends after the headings; expected units and rows", lines.where());
  take_units(layout, lines.cells(), lines.where());
  RowReader reader(layout);
  TrackBuilder builder;
  while (next_row(lines)) reader.read(lines.cells(), lines.where(), builder);
  if (builder.is_empty())
    throw Error("has no rows; expected one for each aircraft and time", lines.where());
  track::Encounter encounter = builder.take();
  if (encounter.aircraft.size() < 2)
    throw Error(fmt::format("holds one aircraft only, '{}'; expected the own one and another",
                            encounter.aircraft[0].name),
                {file.string()});
  return encounter;
}

namespace {

std::vector<track::Track> whole_tracks(const track::Encounter& encounter, const char* format) {
  if (encounter.aircraft.size() < 2)
    throw Error(
        fmt::format("a {} file holds the own aircraft and another; one aircraft is given", format));
  std::vector<track::Track> tracks;
  for (const track::Track& track : encounter.aircraft)
    tracks.push_back(track::with_velocities(track));
  return tracks;
}

Vector3 east_north_up(const Vector3& ned) { return plain(Vector3(ned.y(), ned.x(), -ned.z())); }

}  // namespace

std::string daa_of(const track::Encounter& encounter) {
  const std::vector<track::Track> tracks = whole_tracks(encounter, ".daa");
  std::string text =
      "NAME sx sy sz vx vy vz time\n"
      "[none] [m] [m] [m] [m/s] [m/s] [m/s] [s]\n";
  std::vector<std::size_t> next(tracks.size(), 0);
  for (;;) {
    double time_s = HUGE_VAL;
    for (std::size_t a = 0; a < tracks.size(); ++a)
      if (next[a] < tracks[a].size()) time_s = std::min(time_s, tracks[a].times_s[next[a]]);
    if (time_s == HUGE_VAL) return text;
    for (std::size_t a = 0; a < tracks.size(); ++a) {
      if (next[a] >= tracks[a].size() || tracks[a].times_s[next[a]] != time_s) continue;
      fmt::format_to(std::back_inserter(text),
                     "{} {} {} {}\n",
                     tracks[a].name,
                     fmt::join(east_north_up(tracks[a].positions_ned_m[next[a]]), " "),
                     fmt::join(east_north_up(tracks[a].velocities_ned_mps[next[a]]), " "),
                     time_s);
      ++next[a];
    }
  }
}

std::string state_table_of(const track::Encounter& encounter) {
  std::string text =
      "NAME, east, north, alt, trk, gs, vs, time\n"
      "unitless, [ft], [ft], [ft], [rad], [ftps], [ftps], [s]\n";
  for (const track::Track& track : whole_tracks(encounter, ".txt"))
    for (std::size_t i = 0; i < track.size(); ++i) {
      const Vector3 v = track.velocities_ned_mps[i] / kMetresOfFoot;
      const double course = std::atan2(v.y(), v.x());
      fmt::format_to(std::back_inserter(text),
                     "{}, {}, {}, {}, {}, {}\n",
                     track.name,
                     fmt::join(east_north_up(track.positions_ned_m[i] / kMetresOfFoot), ", "),
                     plain(course < 0 ? course + 2 * kPi : course),
                     v.head<2>().norm(),
                     plain(-v.z()),
                     track.times_s[i]);
    }
  return text;
}

}  // namespace airtruth::tracks_file
