// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <airtruth/export.h>

// The uncertainty of means over sequences. The sample consists of sequences and not of frames,
// because the frames of one sequence are strongly correlated.
namespace airtruth::evaluation {

struct Interval {
  double low = 0;
  double high = 0;
};

// A share in [0, 1] of trials that come in clusters (sequences, whose frames resemble each other),
// with its 95 % interval: Wilson's (1927) with an effective number of trials.
struct Proportion {
  double value = 0;
  double low = 0;
  double high = 1;
  // Weighted where the clusters are; else whole numbers.
  double successes = 0;
  double trials = 0;
  std::int64_t clusters = 0;  // those with a trial
  // (sum w)^2 / sum w^2 of them: their number where all weights are equal.
  double effective_clusters = 0;
};

// The 95 % interval of the weighted mean of values by the percentile bootstrap (Efron 1979,
// "Bootstrap methods: another look at the jackknife"): 10,000 draws with replacement from a fixed
// seed. Empty `weights`: all are equal. The result is empty for fewer than two values.
AIRTRUTH_API std::optional<Interval> bootstrap_mean(std::span<const double> values,
                                                    std::span<const double> weights = {});

// The comparison of two trackers on the same sequences.
struct Paired {
  // Mean of a - b.
  double difference = 0;
  // Bootstrap interval of the difference.
  std::optional<Interval> interval;
  // Two-sided p-value of the difference under random signs (Fisher's permutation test; all sign
  // changes for up to 16 sequences, else 20,000 random ones).
  double p_value = 1;
  // Numbers of sequences that a wins, loses and ties.
  std::int64_t wins = 0, losses = 0, ties = 0;
};
AIRTRUTH_API Paired paired(std::span<const double> a, std::span<const double> b);

// Agreement of two rankings: Kendall's tau-b (Kendall 1945), 1 for the same order and -1 for the
// reverse. Empty where one of them consists of ties alone or has fewer than two values.
AIRTRUTH_API std::optional<double> kendall_tau(std::span<const double> a,
                                               std::span<const double> b);

}  // namespace airtruth::evaluation
