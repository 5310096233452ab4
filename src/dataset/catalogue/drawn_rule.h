// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dataset/catalogue/catalogue.h"
#include "scene/scene/table_reader.h"

namespace airtruth::dataset {

// Reads the tables [[random]] of a catalogue whose backgrounds have been read. Throws Error with
// line and column.
std::vector<Drawn> drawn_rules(const scene::TableReader& root, const Catalogue& catalogue);

// The key `aircraft` of a table: the aircraft of the list that fit its patterns, by type.
std::vector<AircraftType> types_in(const scene::TableReader& table);

}  // namespace airtruth::dataset
