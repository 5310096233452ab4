// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "world/scene/scene.h"
#include "world/scene/table_reader.h"

namespace airtruth::scene {

// The [[intruder]] tables of the file. Ids that the file does not state are intruder-1, intruder-2,
// ...
std::vector<Intruder> intruders_from(const TableReader& root);

// Is it the path of a model (by its ending), not a name of the catalogue?
bool names_model_file(const std::string& aircraft);

}  // namespace airtruth::scene
