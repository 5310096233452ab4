// SPDX-License-Identifier: Apache-2.0
#include "encounter/pairing/distribution.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"

namespace airtruth::pairing {

Distribution::Distribution(std::vector<double> edges,
                           std::vector<double> shares,
                           const std::string& name)
    : edges_(std::move(edges)) {
  const auto is_finite = [](double number) { return std::isfinite(number); };
  if (edges_.empty() || !std::ranges::all_of(edges_, is_finite) ||
      std::ranges::adjacent_find(edges_, std::greater_equal<>()) != edges_.end())
    throw Error(fmt::format("{} is {}; expected one number, or the increasing edges of bins",
                            name,
                            fmt::join(edges_, " ")));
  if (shares.empty())
    for (std::size_t bin = 0; bin + 1 < edges_.size(); ++bin)
      shares.push_back(edges_[bin + 1] - edges_[bin]);
  if (shares.size() + 1 != edges_.size())
    throw Error(fmt::format("{} has {} shares for {} edges; expected one for each bin",
                            name,
                            shares.size(),
                            edges_.size()));
  double sum = 0;
  for (const double share : shares) {
    if (!std::isfinite(share) || share < 0)
      throw Error(fmt::format("{} has a share of {}; expected 0 or more", name, share));
    sums_.push_back(sum += share);
  }
  if (!shares.empty() && !(sum > 0 && std::isfinite(sum)))
    throw Error(fmt::format("{} has shares that sum to {}; expected more than 0", name, sum));
  for (double& running : sums_) running /= sum;
}

double Distribution::quantile(double u) const {
  if (sums_.empty()) return edges_.front();
  // The first bin whose sum exceeds u has a share above 0.
  auto bin = static_cast<std::size_t>(std::ranges::upper_bound(sums_, u) - sums_.begin());
  if (bin == sums_.size())
    bin = static_cast<std::size_t>(std::ranges::lower_bound(sums_, 1.0) - sums_.begin());
  const double before = bin == 0 ? 0 : sums_[bin - 1];
  const double within = std::min(1.0, (u - before) / (sums_[bin] - before));
  return edges_[bin] + (edges_[bin + 1] - edges_[bin]) * within;
}

double Distribution::density(double value) const {
  if (sums_.empty()) return value == edges_.front() ? HUGE_VAL : 0;
  if (value < low() || value > high()) return 0;
  const auto above = std::upper_bound(edges_.begin(), edges_.end() - 1, value);
  const auto bin = static_cast<std::size_t>(above - edges_.begin()) - 1;
  const double before = bin == 0 ? 0 : sums_[bin - 1];
  return (sums_[bin] - before) / (edges_[bin + 1] - edges_[bin]);
}

}  // namespace airtruth::pairing
