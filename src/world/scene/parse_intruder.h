// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "world/scene/scene.h"
#include "world/scene/table_reader.h"

namespace airtruth::scene {

// The [[intruder]] tables of the file. An intruder without an id gets its number: intruder-1,
// intruder-2 and so on.
std::vector<Intruder> intruders_from(const TableReader& root);

// True where the text is the path of a model file (its ending says so); false where it is a name of
// the catalogue.
bool names_model_file(const std::string& aircraft);

}  // namespace airtruth::scene
