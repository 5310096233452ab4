// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dataset/catalogue/distractor_rule.h"
#include "dataset/catalogue/drawn_path.h"
#include "encounter/pairing/geometric.h"
#include "foundation/base/enum_names.h"
#include "scene/scene/scene.h"
#include "scene/synthetic/flight.h"

// A catalogue names backgrounds, aircraft and trajectories, and says which sequences to make of
// them: listed one by one, as a product, or drawn at random from ranges. docs/formats/catalogue.md
// describes the file.
//
// Example: two [[background]] tables, one [[trajectory]], two [[aircraft]] and one [[product]] over
// all of them describe 2 x 1 x 2 = 4 sequences. With a [[random]] rule of count = 10 beside it, the
// catalogue describes 14 (expand.h).
namespace airtruth::encounter {
class Sampler;
}

namespace airtruth::dataset {

namespace fs = std::filesystem;

struct Background {
  std::string name;
  // Either a virtual flight, which is made once in the data set's own folder with the sun and lens
  // below, or a video.
  std::variant<synthetic::FlightOptions, fs::path> source;
  // The mask of a video; a flight brings its own.
  std::optional<fs::path> mask;
  std::int64_t first_frame = 0;
  scene::Lens lens;
  scene::Camera camera;
  scene::Motion motion;
  scene::CameraModel camera_model;
  scene::Realism realism;
  scene::Light light;
  Where where;
};

struct Aircraft {
  std::string name;  // name in this catalogue
  // A name of `airtruth aircraft list`, or a model file.
  std::string aircraft;
  Where where;
};

struct Trajectory {
  std::string name;
  std::vector<Vector3> waypoints_ned_m;
  std::vector<double> times_s;  // set unless speed_mps is
  std::optional<double> speed_mps;
  // In place of the three above.
  std::optional<scene::Encounter> encounter;
  std::vector<scene::Seen> seen;
  std::optional<std::int64_t> frame_count;
  Where where;
};

// One sequence: one of each of the above, by index in the catalogue.
struct Listed {
  std::string name;
  Where where;
  std::size_t background = 0;
  std::size_t trajectory = 0;
  std::size_t aircraft = 0;
  std::optional<std::int64_t> frame_count;
};

// Every combination of the given backgrounds, trajectories and aircraft.
struct Product {
  std::string name;  // pattern with {background}, {trajectory}, {aircraft}
  std::vector<std::size_t> backgrounds, trajectories, aircraft;
  std::optional<std::int64_t> frame_count;
  // Share of sequences without an intruder, from 0 to 1.
  double negatives = 0;
};

struct Range {
  double low = 0;
  double high = 0;
};

// An aircraft of the list with its liveries: "738" with "738/738-Ryanair" and others.
struct AircraftType {
  std::string name;
  std::vector<std::string> liveries;  // names of `airtruth aircraft list`
};

// The sun at a random time of day, at a given place and on a given day (sun_position.h).
struct DaytimeRange {
  // Local solar time in hours; empty: hours that suit the type.
  std::optional<Range> hours;
  double latitude_deg = 45;
  int day_of_year = 172;
};

// The frame of the background at which a clip begins: the background's first_frame, or a random
// frame at which the clip fits.
enum class ClipStart { kFirst, kRandom };

constexpr auto enum_names(ClipStart) {
  return std::to_array<EnumName<ClipStart>>(
      {{ClipStart::kFirst, "first"}, {ClipStart::kRandom, "random"}});
}

// A rule for random intruders that cross the view. At a moment within the clip, the meeting moment,
// each intruder has the range and direction from the camera that the rule draws. It flies straight
// or, with a bank, in a coordinated turn.
struct Drawn {
  std::string name;  // pattern with {index}
  Where where;
  std::int64_t count = 0;
  std::int64_t frame_count = 90;
  std::vector<std::size_t> backgrounds;
  // The type is drawn first, then a livery of that type.
  std::vector<AircraftType> types;
  Range range_m{100, 2000};
  // Replaces range_m: longest side of the exact box at the meeting moment, in px.
  std::optional<Range> size_px;
  // Angle from the boresight, positive to the right.
  Range azimuth_deg{-30, 30};
  Range elevation_deg{-5, 20};  // positive up
  // Empty: a speed that suits the type.
  std::optional<Range> speed_mps;
  Range heading_deg{0, 360};
  // Empty: within 5 degrees and the limits of the type.
  std::optional<Range> climb_deg;
  // Positive with the right wing down. Empty: straight flight, or a bank that suits the type.
  std::optional<Range> bank_deg;
  bool bank_suits_type = false;
  // Each in place of all from range_m to bank_deg.
  std::optional<DrawnApproach> approach;
  std::vector<DrawnSeen> seen;
  // Empty: the sun of the background.
  std::optional<Range> sun_azimuth_deg, sun_elevation_deg;
  // Replaces the two sun ranges.
  std::optional<DaytimeRange> daytime;
  // Share of sequences without an intruder, from 0 to 1.
  double negatives = 0;
  std::int64_t fewest_intruders = 1, most_intruders = 1;
  // True: ids are intruder-1, intruder-2, ...; false: the id is "intruder".
  bool numbers_intruders = false;
  ClipStart start = ClipStart::kFirst;
};

// A rule for encounters: intruders that pass the own aircraft as a model of traffic or a stated
// geometry says, whether or not the camera sees them (encounter/pairing/pair.h).
struct EncounterRule {
  std::string name;  // pattern with {index}
  Where where;
  std::int64_t count = 0;
  std::int64_t frame_count = 240;
  std::vector<std::size_t> backgrounds;
  // One whose class flies the intruder's track is chosen, then a livery of it.
  std::vector<AircraftType> types;
  // The seed of all that is drawn; it follows from the catalogue's and the rule's name.
  std::uint64_t seed = 1;
  // The tracks of `kind = "bayes"` and their file; empty: the geometry below is drawn.
  std::shared_ptr<const encounter::Sampler> tracks;
  fs::path model_file;
  // Times are those of the clip. Tracks of a model use only the time and the miss distances.
  encounter::GeometricOptions geometry;
  // How long the tracks are, in seconds of the clip.
  int length_s = 0;
  // Shares of the sequences, from 0 to 1: without an intruder, and of the others with two.
  double negatives = 0;
  double two_intruders = 0;
};

using Rule = std::variant<Listed, Product, Drawn, EncounterRule>;

struct Catalogue {
  std::string name;
  std::uint64_t seed = 1;
  std::vector<Background> backgrounds;
  std::vector<Aircraft> aircraft;
  std::vector<Trajectory> trajectories;
  std::vector<Rule> rules;
  // Share of sequences without an intruder of the rules that state none of their own.
  double negatives = 0;
  // Of all sequences.
  std::vector<DistractorRule> distractors;
  scene::Truth truth;
  scene::Render render;
  scene::Composite composite;
  scene::Output output;
  // Options "--name=value" for sbatch, from the table [slurm].
  std::vector<std::string> slurm;
  fs::path file;
  std::string text;
};

// Both throw Error with line and column: for the same faults as in scenes, for a name that no table
// has (with the nearest spelling), and for a name that two tables have.
Catalogue read_catalogue(const fs::path& file);
Catalogue parse_catalogue(std::string_view text, const fs::path& file);

}  // namespace airtruth::dataset
