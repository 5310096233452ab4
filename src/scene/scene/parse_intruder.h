// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

namespace airtruth::scene {

// The [[intruder]] tables of the file. An intruder without an id gets its number: intruder-1,
// intruder-2 and so on.
std::vector<Intruder> intruders_from(const TableReader& root);

// The keys of a path and of an attitude in the table of an intruder or a distractor, whose title is
// "[[intruder]]" or "[[distractor]]".
void read_path(const TableReader& table, const char* title, Intruder& intruder);
void read_attitude(const TableReader& table, Intruder& intruder);

}  // namespace airtruth::scene
