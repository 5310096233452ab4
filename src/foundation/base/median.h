// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace airtruth {

// The value before which n others stand in order. It rearranges the values, of which there must be
// more than n.
template <class T>
T nth_smallest(std::vector<T>& values, std::size_t n) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(n);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The value before which this share of the others, below 1, stands in order.
template <class T>
T quantile(std::vector<T>& values, double share) {
  return nth_smallest(values, static_cast<std::size_t>(share * static_cast<double>(values.size())));
}

// The median; for an even number of values, the upper of the two middle values. There must be at
// least one value.
template <class T>
T median(std::vector<T> values) {
  return nth_smallest(values, values.size() / 2);
}

// The median as statistics packages define it: for an even number of values, the mean of the two
// middle values. There must be at least one value.
inline double median_between(std::vector<double> values) {
  const double upper = nth_smallest(values, values.size() / 2);
  if (values.size() % 2 == 1) return upper;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  return (*std::max_element(values.begin(), middle) + upper) / 2;
}

// The standard deviation of normal values over their median absolute deviation (Rousseeuw and Croux
// 1993).
constexpr double kSigmaOfMad = 1.4826;

// Half of the distance between the 16th and the 84th percentile: the standard deviation of normal
// values, whatever a few others are. There must be at least one value.
inline double half_spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return (values[values.size() * 84 / 100] - values[values.size() * 16 / 100]) / 2;
}

template <class T>
T median_or_0(std::vector<T> values) {
  return values.empty() ? T{0} : median(std::move(values));
}

}  // namespace airtruth
