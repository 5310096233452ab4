// SPDX-License-Identifier: Apache-2.0
#include "runners/association/gated_pairs.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "evaluation/matching/assignment.h"

namespace airtruth::association {
namespace {

// Rows and columns that pairs link: nodes 0 to rows - 1, then the columns.
class Groups {
 public:
  explicit Groups(std::size_t nodes) : parent_(nodes) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t of(std::size_t node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }
  void join(std::size_t a, std::size_t b) { parent_[of(a)] = of(b); }

 private:
  std::vector<std::size_t> parent_;
};

std::size_t place_of(std::vector<std::size_t>& list, std::size_t value) {
  const auto found = std::ranges::find(list, value);
  if (found != list.end()) return static_cast<std::size_t>(found - list.begin());
  list.push_back(value);
  return list.size() - 1;
}

// One group: beside the columns each row has one of its own, which leaves it alone.
void solve(const std::vector<const GatedPair*>& pairs,
           double alone_cost,
           std::vector<std::optional<std::size_t>>& column_of_row) {
  std::vector<std::size_t> rows;
  std::vector<std::size_t> columns;
  for (const GatedPair* pair : pairs) {
    place_of(rows, pair->row);
    place_of(columns, pair->column);
  }
  const auto row_count = static_cast<Eigen::Index>(rows.size());
  const auto column_count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(
      row_count, column_count + row_count, std::numeric_limits<double>::infinity());
  for (const GatedPair* pair : pairs) {
    cost(static_cast<Eigen::Index>(place_of(rows, pair->row)),
         static_cast<Eigen::Index>(place_of(columns, pair->column))) = pair->cost;
  }
  for (Eigen::Index row = 0; row < row_count; ++row) {
    cost(row, column_count + row) = alone_cost;
  }
  const auto solution = matching::least_cost_assignment(cost);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (*solution[row] < columns.size()) column_of_row[rows[row]] = columns[*solution[row]];
  }
}

}  // namespace

std::vector<std::optional<std::size_t>> least_cost_pairs(const std::vector<GatedPair>& pairs,
                                                         std::size_t rows,
                                                         std::size_t columns,
                                                         double alone_cost) {
  Groups groups(rows + columns);
  for (const GatedPair& pair : pairs) groups.join(pair.row, rows + pair.column);
  std::map<std::size_t, std::vector<const GatedPair*>> pairs_of_group;
  for (const GatedPair& pair : pairs) pairs_of_group[groups.of(pair.row)].push_back(&pair);
  std::vector<std::optional<std::size_t>> column_of_row(rows);
  for (const auto& [group, own] : pairs_of_group) solve(own, alone_cost, column_of_row);
  return column_of_row;
}

}  // namespace airtruth::association
