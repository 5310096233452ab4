// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dataset/catalogue/drawn_rule.h"
#include "scene/scene/scene.h"

// The random values of a rule of [[random]] for one sequence. No file is read for them.
namespace airtruth::catalogue {

struct Background;

// The geometry with which an intruder passes the camera.
struct Encounter {
  // A name of the aircraft list.
  std::string aircraft;
  // The meeting moment as a share of the clip's time, from 0.2 to 0.8.
  double meeting_share = 0.5;
  // A path by its closest approach, or by what is seen; then nothing below holds.
  std::optional<scene::Encounter> approach;
  // True: the closest approach is at the meeting moment.
  bool approaches_at_meeting = false;
  std::vector<scene::Seen> seen;
  // Distance at the meeting moment; exactly one of range_m and size_px is set.
  std::optional<double> range_m;
  std::optional<double> size_px;
  double azimuth_deg = 0;  // from the boresight, positive to the right
  double elevation_deg = 0;
  double heading_deg = 0;  // at the meeting moment
  double climb_deg = 0;
  double speed_mps = 0;
  double bank_deg = 0;  // positive with the right wing down; 0: straight
};

// Draws where the intruder is at its meeting moment.
void draw_place(Random& random, const MeetingPlace& place, Encounter& encounter);

struct DrawnSequence {
  std::size_t background = 0;
  std::vector<Encounter> encounters;  // empty: a sequence without an intruder
  std::optional<double> sun_azimuth_deg, sun_elevation_deg;
  std::optional<double> visibility_m;
  scene::Weather weather;
  // The beginning of the clip, as a share of the positions that its background offers.
  double start_share = 0;
};

// Draws sequence `index` of a rule; the result depends on rule, backgrounds, seed and index alone.
// Types come equally often, within one in the whole rule where each sequence has as many intruders;
// the liveries of each type are equally frequent. Among any n consecutive sequences the number
// without an intruder is within one of n times the share `negatives`. Sizes and ranges have a
// uniform logarithm. Each number of the weather is stratified by itself, over the sequences with an
// intruder and over those without: of n, each n-th of its range holds one.
DrawnSequence draw(const Drawn& rule,
                   const std::vector<Background>& backgrounds,
                   std::uint64_t seed,
                   std::int64_t index);

// The one of `among` at a share from 0 up to 1 of the sum of their weights.
std::size_t background_at(double share,
                          const std::vector<std::size_t>& among,
                          const std::vector<Background>& backgrounds);

// The background of sequence `index` of `count`, one of `among`: each has its weight's share of all
// sequences, within one.
std::size_t stratified_background(const std::vector<std::size_t>& among,
                                  const std::vector<Background>& backgrounds,
                                  std::uint64_t seed,
                                  std::int64_t count,
                                  std::int64_t index);

// True for a share of the sequences of a rule: of any n in a row for n times that, within one. The
// seed and `what` decide for which.
bool is_chosen(const std::string& what, double share, std::uint64_t seed, std::int64_t index);

struct SunPosition {
  double azimuth_deg = 0;  // from north towards east, 0 to 360
  double elevation_deg = 0;
};

// Returns the sun's position at a local solar time (at 12 h the sun is due south or north), from
// the declination of Cooper (1969), accurate to half a degree. day_of_year is 1 on the first of
// January.
SunPosition sun_position(double hour, double latitude_deg, int day_of_year);

// The hours between which the sun is at least kLowestSunDeg (degrees) above the horizon; empty on a
// day without such an hour.
constexpr double kLowestSunDeg = 3;
std::optional<Range> daylight_hours(double latitude_deg, int day_of_year);

}  // namespace airtruth::catalogue
