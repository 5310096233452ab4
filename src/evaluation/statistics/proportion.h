// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <span>

#include <airtruth/statistics.h>

// A share of trials that succeed, with its 95 % interval, where trials come in clusters: the frames
// of one sequence resemble each other, so the sample consists of sequences.
//
// The interval is Wilson's (1927, J. Am. Stat. Assoc. 22, 209) with an effective number of trials
// in place of the number itself: p (1 - p) / v, where v is the variance of the share between
// clusters, by linearisation of the ratio (Cochran 1977, "Sampling Techniques", 6.13):
//   v = m / (m - 1) * sum (w_i (k_i - p n_i))^2 / (sum w_i n_i)^2
// for m clusters of weight w_i with k_i successes in n_i trials. As in Korn and Graubard (1998,
// Survey Methodology 24, 193) it is multiplied by (1.960 / t)^2 with Student's 97.5 % point of
// m - 1 degrees of freedom, since v is itself an estimate. It is at least 1 and at most the number
// of trials in Kish's sense (1965, "Survey Sampling", 11.7), (sum w_i n_i)^2 / sum w_i^2 n_i, which
// is the number itself where all weights are equal. Where v is 0 because all clusters have the
// share 0 or 1, or where there is one cluster, it is the number of clusters in the same sense,
// (sum w)^2 / sum w^2.
//
// Example: 2 of 2, 0 of 2, 1 of 2 and 2 of 2 in four sequences: p = 5/8, residuals 0.75, -1.25,
// -0.25 and 0.75, v = 4/3 * 2.75 / 64 = 0.0573; p (1 - p) / v = 4.09, times (1.960 / 3.182)^2 =
// 1.55; Wilson's interval of 0.625 with 1.55 trials is 0.13 to 0.95.
//
// With weights the share is the ratio estimator of Hajek (1971) for samples that were drawn with
// unequal probabilities, sum w_i k_i / sum w_i n_i: here of encounters that were drawn from another
// distribution than that of their encounter model (importance sampling).
//
// Example: 2 of 2, 0 of 2 and 1 of 2 with the weights 3, 1 and 2: p = (3 * 2 + 2 * 1) / 12 = 2/3,
// weighted residuals 2, -4/3 and -2/3, v = 3/2 * 56/9 / 144 = 0.0648; p (1 - p) / v = 3.43, times
// (1.960 / 4.303)^2 = 0.71, so 1; Wilson's interval of 0.667 with 1 trial is 0.09 to 0.97.
namespace airtruth::statistics {

using evaluation::Proportion;

struct Cluster {
  double successes = 0;
  double trials = 0;
  double weight = 1;
};

// Clusters without a trial are passed over. Without any trial the share is 0 with the interval
// 0 to 1 and 0 trials.
Proportion proportion_of(std::span<const Cluster> clusters);

// Trials of sequences, which are the clusters.
class TrialsBySequence {
 public:
  void add(std::size_t sequence, bool success);
  bool empty() const { return clusters_.empty(); }
  // `weights`: of the sequences; empty: all are 1.
  Proportion proportion(std::span<const double> weights = {}) const;

 private:
  std::map<std::size_t, Cluster> clusters_;
};

// Wilson's interval of k successes in n trials; both may have fractions. n = 0: from 0 to 1.
evaluation::Interval wilson(double successes, double trials);

}  // namespace airtruth::statistics
