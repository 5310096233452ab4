// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "runners/detector/detector.h"

// The detectors that need no training (docs/detection.md):
//   cmo               close-minus-open of single frames, confirmed at the same bearing in the
//                     frames before; the score is a contrast-to-noise ratio
//   cmo-hmm           a hidden Markov model of a target that moves slowly over the sphere, on
//                     close-minus-open: track before detect
//   frame-difference  what differs from the frame before, once the camera's turn is taken out: the
//                     floor that a detector should clear
// All find aircraft of two to about a hundred pixels, brighter or darker than what is behind them.
// They are deterministic and have no memory beyond the sequence. Nothing is detected on the own
// aircraft where the sequence states its mask. Each has a confident score that follows from its
// statistic: noise alone reaches it once in an hour (kinds.h).
namespace airtruth::classical {

std::vector<std::string> classical_names();
// nullptr for a name that is none of these.
std::unique_ptr<detector::Detector> make_classical(std::string_view name);

}  // namespace airtruth::classical
