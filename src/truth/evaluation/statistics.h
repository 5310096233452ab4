// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

// How sure a mean over sequences is. Sequences are what is drawn: frames of one sequence say much
// the same.
namespace airtruth::evaluation {

struct Interval {
  double low = 0;
  double high = 0;
};

// 95 % interval of the weighted mean of values by the percentile bootstrap (Efron 1979, "Bootstrap
// methods: another look at the jackknife"): 10,000 draws with replacement from a fixed seed.
// `weights` empty: all equal. Empty for fewer than two values.
std::optional<Interval> bootstrap_mean(std::span<const double> values,
                                       std::span<const double> weights = {});

// Two trackers on the same sequences.
struct Paired {
  double difference = 0;             // mean of a - b
  std::optional<Interval> interval;  // of it, by bootstrap
  // Of a difference as large as this either way, were the signs chance (Fisher's permutation test;
  // all sign changes for up to 16 sequences, else 20,000 drawn ones).
  double p_value = 1;
  std::int64_t wins = 0, losses = 0, ties = 0;  // of a
};
Paired paired(std::span<const double> a, std::span<const double> b);

// How far two rankings agree: Kendall's tau-b (Kendall 1945), 1 for the same order, -1 for the
// reverse. Empty where one of them is all ties or has fewer than two.
std::optional<double> kendall_tau(std::span<const double> a, std::span<const double> b);

}  // namespace airtruth::evaluation
