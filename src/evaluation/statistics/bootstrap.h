// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include <airtruth/statistics.h>

#include "foundation/base/seed.h"

// The bootstrap over sequences (Efron 1979): each draw consists of as many sequences as there are,
// drawn with replacement. Frames are not drawn, since those of one sequence resemble each other.
namespace airtruth::statistics {

// How many draws: 1000, or fewer where one draw costs more than 400,000 steps, but 200 at least.
// That is about 2 s on one core.
std::size_t draws_for(std::size_t steps_of_a_draw);

class ClusterDraws {
 public:
  // Draws with the same name and number of sequences are the same.
  ClusterDraws(std::size_t sequences, std::string_view name);
  // How often each sequence is in the next draw.
  std::span<const double> next();

 private:
  Random random_;
  std::vector<double> counts_;
};

// Of values that are sorted and not empty.
double quantile(const std::vector<double>& values, double share);
// From the 2.5 % to the 97.5 % quantile; `values` is not empty.
evaluation::Interval percentile_interval(std::vector<double> values);

}  // namespace airtruth::statistics
