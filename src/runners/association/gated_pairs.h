// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

// The assignment of columns to rows where most pairs are impossible.
namespace airtruth::association {

struct GatedPair {
  std::size_t row = 0;
  std::size_t column = 0;
  double cost = 0;
};

// Returns the column of each row such that the total of the pairs' costs, and of alone_cost for
// each row without a column, is the least. Rows and columns that no pair links, directly or through
// others, are solved apart: the time is that of the largest such group.
std::vector<std::optional<std::size_t>> least_cost_pairs(const std::vector<GatedPair>& pairs,
                                                         std::size_t rows,
                                                         std::size_t columns,
                                                         double alone_cost);

}  // namespace airtruth::association
