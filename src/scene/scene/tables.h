// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

// Readers of the tables that a scene shares with a catalogue of scenes. Each function reads the
// table of its name inside `parent`. A key that the file lacks gets its default.
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
Truth truth_in(const TableReader& parent);
Output output_in(const TableReader& parent);
Render render_in(const TableReader& parent);
Composite composite_in(const TableReader& parent);

// The keys of a table that holds the tables of a camera model: `before`, their names, `after`.
TableReader::Keys with_camera_tables(TableReader::Keys before, const TableReader::Keys& after);

// The key `aircraft` of a table: an unchanged name from the aircraft list, or the path of a model
// file, resolved against the folder of the file that is read.
std::string aircraft_in(const TableReader& table);

}  // namespace airtruth::scene
