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
  // Shift of the background in the picture since the previous frame; empty where it is unknown.
  std::optional<Pixel> background_shift_px;
};

std::vector<Pair> pairs_of(const std::vector<Compared>& all);

// patches.csv: one line for each real (1) and each inserted (0) aircraft of a frame, with its
// centre and every quantity that has a value in one frame. An edge that is nowhere clear has width
// 0.
std::string patches_csv(const std::vector<Compared>& all);

// comparison.md and comparison.json.
std::string table_of(const Comparison& comparison);
std::string json_of(const Comparison& comparison, const fs::path& real);

}  // namespace airtruth::comparison
