// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"

namespace airtruth::scene {

// Adds the [[distractor]] tables of the file to the scene, whose intruders and seed are known:
// those in the air to its intruders, flocks bird by bird, those on the lens to its marks. One
// without an id gets its kind's name and number: bird-1, dirt-2.
void add_distractors(const TableReader& root, Scene& scene);

}  // namespace airtruth::scene
