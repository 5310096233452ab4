// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "comparison/appearance/looks.h"
#include "comparison/comparison/comparison.h"
#include "foundation/geometry/transform.h"

// Computes the quantities of a comparison from the appearance of both aircraft in every frame.
namespace airtruth::comparison {

struct Compared {
  std::int64_t frame = 0;
  appearance::Looks real, made;
  std::vector<float> real_features, made_features;
  // Shift of the background in the picture since the previous frame; empty where it is unknown.
  std::optional<Pixel> background_shift_px;
};

std::vector<Pair> pairs_of(const std::vector<Compared>& all);

// Returns patches.csv: one line of the judge's features for each real and each inserted patch.
std::string patches_csv(const std::vector<Compared>& all);

// comparison.md and comparison.json.
std::string table_of(const Comparison& comparison);
std::string json_of(const Comparison& comparison, const fs::path& real);

}  // namespace airtruth::comparison
