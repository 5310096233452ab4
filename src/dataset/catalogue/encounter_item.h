// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dataset/catalogue/catalogue.h"
#include "scene/scene/scene.h"

// The encounters of a rule of [[encounter_model]]. Each depends on the rule and its index alone.
namespace airtruth::dataset {

// The background of sequence `index`.
std::size_t background_of(const EncounterRule& rule, std::int64_t index);

// Gives the scene, whose camera is the own aircraft, the intruders of sequence `index` and, where
// they come from a model, its weight: the product of those of the intruders. A negative sequence
// gets none. The aircraft is one of the rule whose class flies the track; at its usual speed where
// there is one. Where the own aircraft is higher than kLowestFlightM, so is every intruder.
//
// A track of a model that is too low, or that no aircraft of the rule flies, is drawn again; its
// closest approach falls on a whole second. Throws Error at the rule where no draw of many is
// possible, where a stated geometry goes too low, or where the camera's path ends before the
// closest approach.
void add_encounter(scene::Scene& scene, const EncounterRule& rule, std::int64_t index);

}  // namespace airtruth::dataset
