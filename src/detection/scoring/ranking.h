// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "detection/scoring/average_precision.h"

// The parts of average_precision.h; only this module includes it.
namespace airtruth::detection {

// A detection after the matching of its image.
struct Ranked {
  double score = 0;
  std::size_t sequence = 0;
  bool is_true = false;
};

struct Ranking {
  // By falling score, equal ones in the order of the images; ignored detections are left out.
  std::vector<Ranked> detections;
  std::vector<std::int64_t> truths;  // that count, by sequence
};

using ImageList = std::span<const ScoredImage>;
Ranking ranking_of(std::span<const ImageList> sequences, const PrecisionOptions& options);

// The curve with each sequence counted as often as its weight says. The weighted number of truths
// is above 0.
PrecisionCurve curve_of(const Ranking& ranking, std::span<const double> weights);
// The same with all weights 1; empty without a truth.
std::optional<PrecisionCurve> curve_of(const Ranking& ranking);

}  // namespace airtruth::detection
