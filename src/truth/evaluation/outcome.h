// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "truth/evaluation/metrics.h"

// Frame by frame: what a tracker's answer was worth, and where it lost its object.
namespace airtruth::evaluation {

// Of one frame that shows the target, after the first.
struct Outcome {
  std::size_t frame = 0;  // index of the pair
  double overlap = 0;     // 0 without an answer
  // Of the last answer that there was, the first frame's box at the least.
  double x_px = 0, y_px = 0;  // the answer's centre less the truth's
  double centre_px = 0;
  double normalised = 0;             // over the truth's width and height
  std::optional<double> angle_mrad;  // between the rays to the two centres; needs a lens
};

// The first pair's truth stands for its answer.
std::vector<Outcome> outcomes(std::span<const FramePair> frames, const lens::Lens* lens);

constexpr int kGrace = 10;
constexpr double kLostOverlap = 0.1;

// The frame from which a tracker has lost its object: the first of 10 with the target, one after
// another, whose overlap is at most 0.1 (Kristan et al. 2020, "The eighth visual object tracking
// VOT2020 challenge results", section 3.2); or of fewer where the sequence ends within them.
std::optional<std::size_t> first_loss(std::span<const FramePair> frames);

// Mean values of the outcomes that fall into a bin.
struct Bin {
  double from = 0;  // inclusive
  double to = 0;    // exclusive; infinite for the last
  std::int64_t frames = 0;
  double overlap = 0;
  double success_50 = 0;      // overlap of more than 0.5
  double precision_20px = 0;  // centre within 20 px
  double centre_px = 0;
  double normalised = 0;
  std::optional<double> angle_mrad;
};

// values[i] belongs to outcomes[i]; those without one fall into no bin, those below the first edge
// neither. A bin goes from each edge to the next, the last one on without end. Bins without frames
// are left out.
std::vector<Bin> breakdown(std::span<const Outcome> outcomes,
                           std::span<const std::optional<double>> values,
                           std::span<const double> edges);
Bin mean_of(std::span<const Outcome> outcomes);

}  // namespace airtruth::evaluation
