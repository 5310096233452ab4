// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

// The pairing of rows with columns that has the least total cost: truths with detections, tracks
// with detections. Each row has at most one column, and each column at most one row.
//
// Example: of two tracks (rows) and three detections (columns) with the costs
//   4 1 3
//   2 0 5
// the pairs (0, 1) and (1, 0) cost 1 + 2 = 3, less than any other two; column 2 remains alone.
// least_cost_assignment returns {1, 0}.
namespace airtruth::matching {

// Returns the column of each row; empty for a row without one. Exactly min(rows, columns) rows have
// a column. A cost of +infinity forbids a pair. To maximise a score, pass its negative.
//
// The method is shortest augmenting paths with dual variables, O(rows^2 * columns) for rows <=
// columns: Jonker and Volgenant 1987, Computing 38, in the form for rectangular matrices of Crouse
// 2016, IEEE Transactions on Aerospace and Electronic Systems 52. Among equal totals it chooses as
// scipy.optimize.linear_sum_assignment does, so that measures defined by public toolkits come out
// equal where scores tie.
//
// Throws std::invalid_argument where a cost is NaN or -infinity, and where the forbidden pairs
// leave no assignment of min(rows, columns) pairs.
std::vector<std::optional<std::size_t>> least_cost_assignment(const Eigen::MatrixXd& cost);

// A pair of a matrix in which most are forbidden.
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

}  // namespace airtruth::matching
