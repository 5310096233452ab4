// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <airtruth/metrics.h>

namespace airtruth::measures {

// One number of a sequence's score, by which trackers are compared and ranked, with an interval.
struct ScoreMeasure {
  const char* name;
  std::optional<double> evaluation::Score::*value;
  // Sequences are weighted by their frames, as for GOT-10k's measures.
  bool weighs_by_frames = false;

  double weight_of(const evaluation::Score& score) const {
    return weighs_by_frames ? static_cast<double>(score.counted_after_first) : 1.0;
  }
};

inline constexpr ScoreMeasure kScoreMeasures[] = {
    {"auc", &evaluation::Score::auc},
    {"precision_20px", &evaluation::Score::precision_20px},
    {"normalised_auc", &evaluation::Score::normalised_auc},
    {"average_overlap", &evaluation::Score::average_overlap, true},
    {"success_50", &evaluation::Score::success_50, true},
    {"success_75", &evaluation::Score::success_75, true},
    {"centre_mean_px", &evaluation::Score::centre_mean_px},
    {"x_mean_px", &evaluation::Score::x_mean_px},
    {"x_rmse_px", &evaluation::Score::x_rmse_px},
    {"x_most_px", &evaluation::Score::x_most_px},
    {"y_mean_px", &evaluation::Score::y_mean_px},
    {"y_rmse_px", &evaluation::Score::y_rmse_px},
    {"y_most_px", &evaluation::Score::y_most_px},
    {"frames_per_second", &evaluation::Score::frames_per_second},
    {"frames_per_second_median", &evaluation::Score::frames_per_second_median}};

}  // namespace airtruth::measures
