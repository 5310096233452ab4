// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dataset/catalogue/catalogue.h"
#include "scene/scene/table_reader.h"

namespace airtruth::dataset {

// Encounters are drawn before the frame rate of a video is known, for clips of this rate or more.
constexpr double kSlowestRateHz = 24;

// Where a data set keeps the model of a rule, below its folder.
fs::path kept_model(const fs::path& folder, const fs::path& model_file);

// Reads the tables [[encounter_model]] of a catalogue whose seed and backgrounds have been read,
// and the models that they name: a file beside the catalogue, or where the catalogue is the copy in
// a data set, the copy there. Throws Error with line and column.
std::vector<EncounterRule> encounter_rules(const scene::TableReader& root,
                                           const Catalogue& catalogue);

}  // namespace airtruth::dataset
