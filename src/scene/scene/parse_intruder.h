// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

namespace airtruth::scene {

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
