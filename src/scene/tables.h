// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "scene/scene.h"
#include "scene/table_reader.h"

// The tables that a scene shares with a catalogue of scenes. Each reads the table of its name
// inside `parent`, with every default where the file has none.
namespace airtruth::scene {

constexpr std::size_t kLargestToml = std::size_t{16} << 20;

// Error with line and column: too long, not UTF-8, nested too deep, not TOML.
toml::table parsed_toml(std::string_view text, const std::string& file);

Lens lens_in(const TableReader& parent);
Camera camera_in(const TableReader& parent);
Motion motion_in(const TableReader& parent);
Light light_in(const TableReader& parent);
Output output_in(const TableReader& parent);
Render render_in(const TableReader& parent);
Composite composite_in(const TableReader& parent);

}  // namespace airtruth::scene
