// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "dataset/sequences/labels_of_truth.h"
#include "detection/scoring/truth.h"

// The truth of a sequence that `render` made; a part of set_truth.h.
namespace airtruth::detection {

struct RenderedTruth {
  TruthSequence truth;  // without duration
  bool has_weight = false;
  // The frame of the background video that became the sequence's first.
  std::int64_t first_background_frame = 0;
};

RenderedTruth rendered_truth(const std::filesystem::path& folder,
                             dataset::Boxes boxes,
                             const std::string& volume);

}  // namespace airtruth::detection
