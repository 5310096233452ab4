// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dataset/catalogue/distractors.h"
#include "dataset/catalogue/drawn_rule.h"
#include "dataset/catalogue/encounter_rule.h"
#include "foundation/base/files.h"
#include "scene/scene/scene.h"
#include "scene/synthetic/flight.h"

// A catalogue names backgrounds, aircraft and trajectories, and says which sequences to make of
// them: listed one by one, as a product, or drawn at random from ranges. docs/formats/catalogue.md
// describes the file.
//
// Example: two [[background]] tables, one [[trajectory]], two [[aircraft]] and one [[product]] over
// all of them describe 2 x 1 x 2 = 4 sequences. With a [[random]] rule of count = 10 beside it, the
// catalogue describes 14 (expand.h).
namespace airtruth::catalogue {

struct Background : scene::CameraTables {
  std::string name;
  // Either a virtual flight, which is made once in the data set's own folder with the sun and lens
  // below, or a video.
  std::variant<synthetic::FlightOptions, fs::path> source;
  // The mask of a video; a flight brings its own.
  std::optional<fs::path> mask;
  std::int64_t first_frame = 0;
  // Frames that are used, from first_frame on; empty: to the video's end.
  std::optional<std::int64_t> frame_count;
  // Of numbered pictures, which state none.
  std::optional<double> frame_rate_hz;
  // How often rules draw it, relative to others.
  double weight = 1;
  Where where;
};

// Where the part of a video of so many frames (0: unknown) ends that the background uses, counted
// from the video's first frame; 0: unknown.
std::int64_t end_of(const Background& background, std::int64_t frames);

struct Aircraft {
  std::string name;  // name in this catalogue
  // A name of `airtruth aircraft list`, or a model file.
  std::string aircraft;
  Where where;
};

struct Trajectory {
  std::string name;
  scene::Intruder flown;  // without its id and its aircraft
  std::optional<std::int64_t> frame_count;
};

// Every combination of the given backgrounds, trajectories and aircraft, by index in the catalogue;
// a sequence of [[sequence]] is that of one of each.
struct Product {
  std::string name;  // pattern with {background}, {trajectory}, {aircraft}
  std::vector<std::size_t> backgrounds, trajectories, aircraft;
  std::optional<std::int64_t> frame_count;
  // Share of sequences without an intruder, from 0 to 1.
  double negatives = 0;
  Where where;
};

// [stream]: how a training stream draws pictures from the rules (dataset/stream/stream.h). Data
// sets are built without it.
struct StreamTable {
  // Width and height of the part of a frame that is shown; empty: the whole frame.
  std::optional<std::array<int, 2>> crop_px;
  // Number of consecutive frames of a sample.
  std::int64_t frames = 1;
  // How many aircraft a sample has that is not without any; empty: as many as its rule says.
  std::optional<WholeRange> intruders;
  // True: samples have the pixels of each intruder.
  bool masks = false;
  // Share of samples that are shown as another camera than the background's has them
  // (dataset/stream/other_camera.h), 0 to 1.
  double other_cameras = 0;
  // Number of samples that are made of a decoded frame.
  std::int64_t reuse = 8;
  // For decoded frames, in MB of 10^6 bytes.
  std::int64_t memory_mb = 1500;
};

using Rule = std::variant<Product, Drawn, EncounterRule>;

struct Catalogue : scene::OutputTables {
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
  StreamTable stream;
  // Options "--name=value" for sbatch, from the table [slurm].
  std::vector<std::string> slurm;
  fs::path file;
  std::string text;
};

// Both throw Error with line and column: for the same faults as in scenes, for a name that no table
// has (with the nearest spelling), and for a name that two tables have.
Catalogue read_catalogue(const fs::path& file);
Catalogue parse_catalogue(std::string_view text, const fs::path& file);

}  // namespace airtruth::catalogue
