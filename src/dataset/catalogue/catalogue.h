// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "world/scene/scene.h"
#include "world/synthetic/flight.h"

// A catalogue: backgrounds, aircraft and trajectories by name, and the sequences to make of them,
// listed one by one, as a product, or drawn at random from ranges. docs/formats/catalogue.md
// describes the file.
namespace airtruth::dataset {

namespace fs = std::filesystem;

struct Background {
  std::string name;
  // A virtual flight, made once in the data set's own folder (its sun and lens are those below); or
  // a video.
  std::variant<synthetic::FlightOptions, fs::path> source;
  std::optional<fs::path> mask;  // of a video; a flight brings its own
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
  std::string name;      // in this catalogue
  std::string aircraft;  // of `airtruth aircraft list`, or a model file
  Where where;
};

struct Trajectory {
  std::string name;
  std::vector<Vector3> waypoints_ned_m;
  std::vector<double> times_s;  // or
  std::optional<double> speed_mps;
  std::optional<std::int64_t> frame_count;
  Where where;
};

// One of the above each, by its place in the catalogue.
struct Listed {
  std::string name;
  Where where;
  std::size_t background = 0;
  std::size_t trajectory = 0;
  std::size_t aircraft = 0;
  std::optional<std::int64_t> frame_count;
};

// Every background with every trajectory with every aircraft.
struct Product {
  std::string name;  // pattern with {background}, {trajectory}, {aircraft}
  std::vector<std::size_t> backgrounds, trajectories, aircraft;
  std::optional<std::int64_t> frame_count;
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

// The sun at a time of day that is drawn, at a place and on a day (sun_position.h).
struct DaytimeRange {
  std::optional<Range> hours;  // local solar time; empty: hours that suit the type
  double latitude_deg = 45;
  int day_of_year = 172;
};

// Intruders that cross the view: at a moment within the clip, the meeting moment, each is at a
// range and a direction from the camera; it flies straight or, with a bank, in a coordinated turn.
struct Drawn {
  std::string name;  // pattern with {index}
  Where where;
  std::int64_t count = 0;
  std::int64_t frame_count = 90;
  std::vector<std::size_t> backgrounds;
  std::vector<AircraftType> types;  // drawn first; then a livery of the type
  Range range_m{100, 2000};
  std::optional<Range> size_px;  // longest side of the exact box at the meeting moment; in place of
                                 // range_m
  Range azimuth_deg{-30, 30};    // from the boresight, to the right
  Range elevation_deg{-5, 20};   // up
  std::optional<Range> speed_mps;  // empty: suits the type
  Range heading_deg{0, 360};
  std::optional<Range> climb_deg;  // empty: within 5 degrees, and what suits the type
  std::optional<Range> bank_deg;   // right wing down; empty: straight, or what suits the type
  bool bank_suits_type = false;
  std::optional<Range> sun_azimuth_deg, sun_elevation_deg;  // else the background's
  std::optional<DaytimeRange> daytime;                      // in place of these two
  double negatives = 0;  // share of sequences without an intruder
  std::int64_t fewest_intruders = 1, most_intruders = 1;
  bool numbers_intruders = false;  // ids are intruder-1, intruder-2, ...; else "intruder"
  bool starts_at_random = false;   // anywhere in the background where the clip fits
};

using Rule = std::variant<Listed, Product, Drawn>;

struct Catalogue {
  std::string name;
  std::uint64_t seed = 1;
  std::vector<Background> backgrounds;
  std::vector<Aircraft> aircraft;
  std::vector<Trajectory> trajectories;
  std::vector<Rule> rules;
  scene::Render render;
  scene::Composite composite;
  scene::Output output;
  std::vector<std::string> slurm;  // "--name=value" for sbatch, of the table [slurm]
  fs::path file;
  std::string text;
};

// Errors carry line and column: as for scenes, and names that no table has (nearest spelling) or
// two tables have.
Catalogue read_catalogue(const fs::path& file);
Catalogue parse_catalogue(std::string_view text, const fs::path& file);

}  // namespace airtruth::dataset
