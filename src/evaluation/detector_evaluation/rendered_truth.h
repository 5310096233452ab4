// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "dataset/sequences/labels_of_truth.h"
#include "encounter/separation/measures.h"
#include "encounter/separation/violation.h"
#include "evaluation/scores/truth.h"

// The truth of a sequence that `render` made; a part of set_truth.h.
namespace airtruth::detector_evaluation {

struct RenderedTruth {
  scores::TruthSequence truth;  // without duration
  bool has_weight = false;
  // The frame of the background video that became the sequence's first.
  std::int64_t first_background_frame = 0;
};

RenderedTruth rendered_truth(const std::filesystem::path& folder,
                             dataset::Boxes boxes,
                             const std::string& volume);

// The own aircraft and an intruder at one frame.
struct PairState {
  double time_s = 0;
  encounter::Mover own;
  encounter::Mover intruder;
};

// The first time at which the states violate the volume: within the frames, between which positions
// and velocities are interpolated, or within `lookahead_s` after the last of them, from which on
// both keep their velocities. Empty where they never do. For volumes that the scene did not ask
// for; sequence.json states the violations of the others along the whole paths.
std::optional<double> first_violation_s(const encounter::Volume& volume,
                                        std::span<const PairState> states,
                                        double lookahead_s);

}  // namespace airtruth::detector_evaluation
