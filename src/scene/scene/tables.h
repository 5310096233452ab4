// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

// Readers of tables, most of which a scene shares with a catalogue of scenes. Each function reads
// the table of its name inside `parent`. A key that the file lacks gets its default.
namespace airtruth::scene {

// Largest TOML file, in bytes: 16 MiB.
constexpr std::size_t kLargestToml = std::size_t{16} << 20;

// Parses the text. Throws Error with line and column where it is too long, not UTF-8, nested too
// deep or not TOML.
toml::table parsed_toml(std::string_view text, const std::string& file);

Lens lens_in(const TableReader& parent);
// `motion` belongs to the same clip: whether a log's attitude is followed depends on it.
Camera camera_in(const TableReader& parent, const Motion& motion);
Motion motion_in(const TableReader& parent);
CameraModel camera_model_in(const TableReader& parent);
Weather weather_in(const TableReader& parent);
Realism realism_in(const TableReader& parent);
Light light_in(const TableReader& parent);
std::vector<Occluder> occluders_in(const TableReader& parent);
OutputTables output_tables_in(const TableReader& parent);

// The keys of a table that holds the tables of a camera model: `before`, their names, `after`.
TableReader::Keys with_camera_tables(TableReader::Keys before, const TableReader::Keys& after);

// The key `aircraft` of a table: an unchanged name from the aircraft list, or the path of a model
// file, resolved against the folder of the file that is read.
std::string aircraft_in(const TableReader& table);

// The [[intruder]] tables of the file. An intruder without an id gets its number: intruder-1,
// intruder-2 and so on.
std::vector<Intruder> intruders_from(const TableReader& root);

// Adds the [[distractor]] tables of the file to the scene, whose intruders and seed are known:
// those in the air to its intruders, flocks bird by bird, those on the lens to its marks. One
// without an id gets its kind's name and number: bird-1, dirt-2.
void add_distractors(const TableReader& root, Scene& scene);

inline const TableReader::Keys kEncounterKeys = keys(
    "cpa_time_s cpa_right_m cpa_above_m cpa_ahead_m course_deg speed_mps "
    "climb_mps turn_rate_dps");

// The table `encounter` of an intruder or a trajectory. Throws Error where it climbs faster than it
// flies.
Encounter encounter_in(const TableReader& parent);

// The tables [[seen]] of an intruder or a trajectory; empty where there are none. Throws Error for
// a single one and for times that do not increase.
std::vector<Seen> seen_in(const TableReader& parent);

// The keys of a path and of an attitude in the table of an intruder or a distractor, whose title is
// "[[intruder]]" or "[[distractor]]".
void read_path(const TableReader& table, const char* title, Intruder& intruder);
void read_attitude(const TableReader& table, Intruder& intruder);

}  // namespace airtruth::scene
