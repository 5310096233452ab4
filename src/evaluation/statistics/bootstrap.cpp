// SPDX-License-Identifier: Apache-2.0
#include "evaluation/statistics/bootstrap.h"

#include <algorithm>
#include <string>

namespace airtruth::statistics {
namespace {

constexpr std::size_t kDraws = 1000;  // as Efron and Tibshirani (1993) ask for percentiles
// Least number of draws, where each takes long: a choice.
constexpr std::size_t kFewestDraws = 200;
constexpr std::size_t kMostSteps = 400'000'000;  // of all draws: about 2 s on one core

}  // namespace

std::size_t draws_for(std::size_t steps_of_a_draw) {
  return std::clamp(kMostSteps / std::max<std::size_t>(1, steps_of_a_draw), kFewestDraws, kDraws);
}

ClusterDraws::ClusterDraws(std::size_t sequences, std::string_view name)
    : random_(Seed(1).stream(std::string(name))), counts_(sequences) {}

std::span<const double> ClusterDraws::next() {
  std::fill(counts_.begin(), counts_.end(), 0.0);
  const auto n = static_cast<double>(counts_.size());
  for (std::size_t i = 0; i < counts_.size(); ++i)
    counts_[std::min(counts_.size() - 1, static_cast<std::size_t>(random_.uniform() * n))] += 1;
  return counts_;
}

// Interpolates between the two nearest (Hyndman and Fan 1996, type 7).
double quantile(const std::vector<double>& values, double share) {
  const double position = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
}

evaluation::Interval percentile_interval(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.025), quantile(values, 0.975)};
}

}  // namespace airtruth::statistics
