// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "dataset/set_report/portrait.h"
#include "scene/scene/scene.h"

namespace airtruth::set_report {

// The data card of a set as pairs of a heading and its text: what the set is, how it was made, and
// what its labels do not say. Every sentence is computed from the records of the sequences, and is
// left out where they lack the information.
using Card = std::vector<std::pair<std::string, std::string>>;

Card card_of(const std::filesystem::path& set, const std::vector<Portrait>& portraits);

// Describes which camera effects were applied to the intruders' light and which were not, according
// to the effective scenes of the rendered sequences (scene_toml in sequence.json).
std::string camera_sentence(const std::vector<scene::Scene>& scenes);
// Describes how the intruders follow the camera's motion.
std::string motion_sentence(const std::vector<scene::Scene>& scenes);

}  // namespace airtruth::set_report
