// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "dataset/page/portrait.h"
#include "world/scene/scene.h"

namespace airtruth::dataset {

// The data card of a set: what it is, how it was made, and what its labels do not say. Every
// sentence is computed from the sequences' own records, or left out.
using Card = std::vector<std::pair<std::string, std::string>>;

Card card_of(const std::filesystem::path& set, const std::vector<Portrait>& portraits);

// What the intruders' light passed through on its way to the samples, and what it did not, by the
// effective scenes of the rendered sequences (sequence.json's scene_toml).
std::string camera_sentence(const std::vector<scene::Scene>& scenes);
// How the intruders follow the camera's motion.
std::string motion_sentence(const std::vector<scene::Scene>& scenes);

}  // namespace airtruth::dataset
