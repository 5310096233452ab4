// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dataset/catalogue/table_values.h"
#include "foundation/base/seed.h"
#include "scene/scene/camera_keys.h"
#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

// The tables [[random]] of a catalogue. Its paths may be given as a scene gives them, by closest
// approach or by what is seen, with numbers to draw.
namespace airtruth::catalogue {

struct Catalogue;

// A number that a rule draws: evenly from low to high, or one of a list. In a file it is a number,
// [low, high] or { any_of = [...] }.
struct DrawnNumber {
  // The least and the greatest.
  double low = 0;
  double high = 0;
  std::vector<double> any_of;  // empty: all of the range

  double draw(Random& random) const;
  // The number at a share from 0 up to 1: of a range evenly, or in its logarithm.
  double at(double share) const;
  double at_in_logarithm(double share) const;
};

// [random.encounter]. Empty: as in a scene, but for cpa_time_s (the meeting moment) and speed_mps
// (one that suits the type).
struct DrawnApproach {
  std::optional<DrawnNumber> cpa_time_s, cpa_right_m, cpa_ahead_m, speed_mps;
  DrawnNumber cpa_above_m, climb_mps, turn_rate_dps;
  DrawnNumber course_deg{0, 360, {}};
  Where where;

  // `usual_speed_mps` stands for a speed that the rule does not state. A cpa_time_s that it does
  // not state is 0.
  scene::Encounter draw(Random random, double usual_speed_mps) const;
};

// [[random.seen]]
struct DrawnSeen {
  DrawnNumber time_s, x_px, y_px;
  std::optional<DrawnNumber> range_m, width_px;
  Where where;

  scene::Seen draw(Random& random) const;
};

// [random.weather]: [weather] of a scene (scene/scene/camera_keys.h) with numbers to draw.
struct DrawnWeather {
  // In place of the extinction of the background's air.
  std::optional<DrawnNumber> visibility_m;
  // In the order of scene::kWeatherKeys.
  std::array<std::optional<DrawnNumber>, scene::kWeatherKeys.size()> factors;
  Where where;
};

// An aircraft of the list with its liveries: "738" with "738/738-Ryanair" and others.
struct AircraftType {
  std::string name;
  std::vector<std::string> liveries;  // names of `airtruth aircraft list`

  bool operator==(const AircraftType&) const = default;
};

// What a rule states that numbers its sequences: [[random]] and [[encounter_model]].
struct NumberedRule {
  std::string name;  // pattern with {index}
  Where where;
  std::int64_t count = 0;
  std::int64_t frame_count = 0;
  std::vector<std::size_t> backgrounds;
  std::vector<AircraftType> types;
  // Share of sequences without an intruder, from 0 to 1.
  double negatives = 0;
};

// Reads all but the negatives: the aircraft are those of the list that fit the patterns of the key
// `aircraft`, by type.
NumberedRule numbered_rule(const scene::TableReader& table,
                           const Catalogue& catalogue,
                           const char* usual_name,
                           std::int64_t usual_frames,
                           std::int64_t most_frames);

// The sun at a random time of day, at a given place and on a given day (drawing.h).
struct DaytimeRange {
  // Local solar time in hours; empty: hours that suit the type.
  std::optional<Range> hours;
  double latitude_deg = 45;
  int day_of_year = 172;
};

// Where an intruder is at its meeting moment.
struct MeetingPlace {
  Range range_m{100, 2000};
  // Replaces range_m: longest side of the exact box, in px.
  std::optional<Range> size_px;
  // Angle from the boresight, positive to the right.
  Range azimuth_deg{-30, 30};
  Range elevation_deg{-5, 20};  // positive up
  Range heading_deg{0, 360};
};

// Reads the keys of a place that are there.
void read_place(const scene::TableReader& table, MeetingPlace& place);

// A rule for random intruders that cross the view. At a moment within the clip, the meeting moment,
// each intruder has the range and direction from the camera that the rule draws. It flies straight
// or, with a bank, in a coordinated turn. The types take turns; the livery is drawn.
struct Drawn : NumberedRule {
  MeetingPlace place;
  // Empty: a speed that suits the type.
  std::optional<Range> speed_mps;
  // Empty: within 5 degrees and the limits of the type.
  std::optional<Range> climb_deg;
  // Positive with the right wing down. Empty: straight flight, or a bank that suits the type.
  std::optional<Range> bank_deg;
  bool bank_suits_type = false;
  // Each in place of all from `place` to bank_deg.
  std::optional<DrawnApproach> approach;
  std::vector<DrawnSeen> seen;
  // Empty: the sun of the background.
  std::optional<Range> sun_azimuth_deg, sun_elevation_deg;
  // Replaces the two sun ranges.
  std::optional<DaytimeRange> daytime;
  std::optional<DrawnWeather> weather;
  WholeRange intruders;
  // True: ids are intruder-1, intruder-2, ...; false: the id is "intruder".
  bool numbers_intruders = false;
  // True: the clip begins at a random frame at which it fits; false: at the background's first.
  bool starts_at_random = false;
};

// Reads the tables [[random]] of a catalogue whose backgrounds have been read. Throws Error with
// line and column.
std::vector<Drawn> drawn_rules(const scene::TableReader& root, const Catalogue& catalogue);

}  // namespace airtruth::catalogue
