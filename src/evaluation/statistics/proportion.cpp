// SPDX-License-Identifier: Apache-2.0
#include "evaluation/statistics/proportion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace airtruth::statistics {
namespace {

// The 97.5 % point of the normal distribution.
constexpr double kNormal = 1.959963984540054;

// The 97.5 % point of Student's distribution; tabulated up to 30 degrees of freedom, then by the
// expansion of Cornish and Fisher (Abramowitz and Stegun 1964, 26.7.5), which is within 1e-4 there.
double student(std::int64_t degrees) {
  constexpr std::array<double, 30> kTable = {
      12.7062, 4.30265, 3.18245, 2.77645, 2.57058, 2.44691, 2.36462, 2.30600, 2.26216, 2.22814,
      2.20099, 2.17881, 2.16037, 2.14479, 2.13145, 2.11991, 2.10982, 2.10092, 2.09302, 2.08596,
      2.07961, 2.07387, 2.06866, 2.06390, 2.05954, 2.05553, 2.05183, 2.04841, 2.04523, 2.04227};
  if (degrees <= std::ssize(kTable)) return kTable[static_cast<std::size_t>(degrees - 1)];
  const double n = static_cast<double>(degrees);
  const double z = kNormal;
  const double z3 = z * z * z;
  return z + (z3 + z) / (4 * n) + (5 * z3 * z * z + 16 * z3 + 3 * z) / (96 * n * n);
}

}  // namespace

evaluation::Interval wilson(double successes, double trials) {
  if (!(trials > 0)) return {0, 1};
  const double p = std::clamp(successes / trials, 0.0, 1.0);
  const double z2 = kNormal * kNormal;
  const double middle = (p + z2 / (2 * trials)) / (1 + z2 / trials);
  const double half =
      kNormal / (1 + z2 / trials) * std::sqrt(p * (1 - p) / trials + z2 / (4 * trials * trials));
  // Rounding must not move the ends of shares of 0 and 1.
  return {p == 0 ? 0 : std::max(0.0, middle - half), p == 1 ? 1 : std::min(1.0, middle + half)};
}

Proportion proportion_of(std::span<const Cluster> clusters) {
  Proportion share;
  double weights = 0;
  double squares = 0;
  double trial_squares = 0;
  for (const Cluster& cluster : clusters) {
    if (!(cluster.trials > 0) || !(cluster.weight > 0)) continue;
    share.successes += cluster.weight * cluster.successes;
    share.trials += cluster.weight * cluster.trials;
    weights += cluster.weight;
    squares += cluster.weight * cluster.weight;
    trial_squares += cluster.weight * cluster.weight * cluster.trials;
    ++share.clusters;
  }
  if (share.clusters == 0) return share;
  const double p = share.value = std::clamp(share.successes / share.trials, 0.0, 1.0);
  double variance = 0;
  for (const Cluster& cluster : clusters) {
    if (!(cluster.trials > 0) || !(cluster.weight > 0)) continue;
    const double residual = cluster.weight * (cluster.successes - p * cluster.trials);
    variance += residual * residual;
  }
  const double most = share.trials * share.trials / trial_squares;
  double trials = share.effective_clusters = weights * weights / squares;
  if (share.clusters > 1 && p > 0 && p < 1) {
    const double m = static_cast<double>(share.clusters);
    variance *= m / (m - 1) / (share.trials * share.trials);
    const double shrink = kNormal / student(share.clusters - 1);
    const double effective = variance > 0 ? p * (1 - p) / variance * shrink * shrink : most;
    trials = std::clamp(effective, std::min(1.0, most), most);
  }
  const evaluation::Interval interval = wilson(p * trials, trials);
  share.low = interval.low;
  share.high = interval.high;
  return share;
}

void TrialsBySequence::add(std::size_t sequence, bool success) {
  Cluster& cluster = clusters_[sequence];
  cluster.trials += 1;
  cluster.successes += success ? 1 : 0;
}

Proportion TrialsBySequence::proportion(std::span<const double> weights) const {
  std::vector<Cluster> clusters;
  for (const auto& [sequence, cluster] : clusters_) {
    clusters.push_back(cluster);
    if (!weights.empty()) clusters.back().weight = weights[sequence];
  }
  return proportion_of(clusters);
}

}  // namespace airtruth::statistics
