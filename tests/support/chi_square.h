// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

// Pearson's test of counts against probabilities, for tests of what is drawn.
namespace airtruth::test_support {

// Statistics of independent tables add up, and so do their degrees of freedom.
struct ChiSquare {
  double statistic = 0;
  double degrees = 0;

  // Adds a table of counts whose bins have these probabilities. Bins with fewer than 5 expected
  // counts are taken together, as is usual (Cochran 1954). A count in a bin of probability 0 makes
  // the statistic infinite.
  void add(const std::vector<double>& counts, const std::vector<double>& probabilities) {
    double total = 0;
    for (const double count : counts) total += count;
    double rest_count = 0, rest_expected = 0, tested = 0;
    const auto take = [&](double count, double expected) {
      statistic += (count - expected) * (count - expected) / expected;
      ++tested;
    };
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const double expected = total * probabilities[k];
      if (!(probabilities[k] > 0) && counts[k] > 0) statistic = HUGE_VAL;
      if (expected >= 5) {
        take(counts[k], expected);
      } else {
        rest_count += counts[k];
        rest_expected += expected;
      }
    }
    if (rest_expected >= 5) take(rest_count, rest_expected);
    if (tested > 1) degrees += tested - 1;
    // A single tested bin has no freedom, and tells nothing.
  }

  // The statistic as a value of the standard normal distribution (Wilson and Hilferty 1931): below
  // 3.09 it is accepted at the level 0.001.
  double normal_deviate() const {
    const double spread = 2 / (9 * degrees);
    return (std::cbrt(statistic / degrees) - (1 - spread)) / std::sqrt(spread);
  }
};

// The deviate that a correct sampler exceeds once in a thousand tests.
constexpr double kLevel0001 = 3.09;

}  // namespace airtruth::test_support
