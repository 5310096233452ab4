// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "world/scene/scene.h"
#include "world/scene/table_reader.h"

// The tables that a scene shares with a catalogue of scenes. Each reads the table of its name
// inside `parent`, with every default where the file has none.
namespace airtruth::scene {

constexpr std::size_t kLargestToml = std::size_t{16} << 20;

// Error with line and column: too long, not UTF-8, nested too deep, not TOML.
toml::table parsed_toml(std::string_view text, const std::string& file);

Lens lens_in(const TableReader& parent);
Camera camera_in(const TableReader& parent);
Motion motion_in(const TableReader& parent);
CameraModel camera_model_in(const TableReader& parent);
Realism realism_in(const TableReader& parent);
Light light_in(const TableReader& parent);
Output output_in(const TableReader& parent);
Render render_in(const TableReader& parent);
Composite composite_in(const TableReader& parent);

// The key `aircraft` of a table: a name of the aircraft list as it stands, or the path of a model
// file, taken from the folder of the file that is read.
std::string aircraft_in(const TableReader& table);

}  // namespace airtruth::scene
