// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

namespace airtruth::scene {

// The table `encounter` of an intruder or a trajectory. Throws Error where it climbs faster than it
// flies.
Encounter encounter_in(const TableReader& parent);

// The tables [[seen]] of an intruder or a trajectory; empty where there are none. Throws Error for
// a single one and for times that do not increase.
std::vector<Seen> seen_in(const TableReader& parent);

}  // namespace airtruth::scene
