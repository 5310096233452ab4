// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "world/scene/scene.h"
#include "world/scene/table_reader.h"

namespace airtruth::scene {

// The [[intruder]] tables of the file. An intruder without an id gets its number: intruder-1,
// intruder-2 and so on.
std::vector<Intruder> intruders_from(const TableReader& root);

}  // namespace airtruth::scene
