// SPDX-License-Identifier: Apache-2.0
#include "evaluation/matching/assignment.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace airtruth::matching {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// Returns the column of each row; rows are at most as many as columns. Each row in turn gets a
// column by the shortest path of reduced costs from the row to a free column.
std::vector<std::size_t> solved(const Eigen::MatrixXd& cost) {
  const auto rows = static_cast<std::size_t>(cost.rows());
  const auto columns = static_cast<std::size_t>(cost.cols());
  std::vector<double> row_dual(rows), column_dual(columns), path_cost(columns);
  std::vector<std::size_t> column_of_row(rows, kNone), row_of_column(columns, kNone);
  std::vector<std::size_t> path_row(columns, kNone), remaining(columns), reached;
  for (std::size_t first_row = 0; first_row < rows; ++first_row) {
    // Dijkstra's search over columns. The order of `remaining` and the preference for a free column
    // decide among equal costs; the header promises scipy's choice.
    path_cost.assign(columns, kInfinity);
    remaining.resize(columns);
    for (std::size_t k = 0; k < columns; ++k) remaining[k] = columns - 1 - k;
    reached.clear();
    double reached_cost = 0;
    for (std::size_t row = first_row; row != kNone; row = row_of_column[reached.back()]) {
      // The cheapest path to every remaining column by way of the row, and the nearest of them.
      std::size_t nearest = 0;
      double lowest = kInfinity;
      for (std::size_t k = 0; k < remaining.size(); ++k) {
        const std::size_t column = remaining[k];
        const double through =
            reached_cost + cost(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) -
            row_dual[row] - column_dual[column];
        if (through < path_cost[column]) {
          path_cost[column] = through;
          path_row[column] = row;
        }
        if (path_cost[column] < lowest ||
            (path_cost[column] == lowest && row_of_column[column] == kNone)) {
          lowest = path_cost[column];
          nearest = k;
        }
      }
      reached.push_back(remaining[nearest]);
      reached_cost = path_cost[reached.back()];
      if (reached_cost == kInfinity)
        throw std::invalid_argument("assignment: the forbidden pairs leave no assignment");
      remaining[nearest] = remaining.back();
      remaining.pop_back();
    }
    row_dual[first_row] += reached_cost;
    for (const std::size_t column : reached) {
      const double saved = reached_cost - path_cost[column];
      column_dual[column] -= saved;
      if (row_of_column[column] != kNone) row_dual[row_of_column[column]] += saved;
    }
    // The rows along the path change to its columns.
    std::size_t column = reached.back();
    for (std::size_t row = kNone; row != first_row;) {
      row = row_of_column[column] = path_row[column];
      std::swap(column_of_row[row], column);
    }
  }
  return column_of_row;
}

}  // namespace

std::vector<std::optional<std::size_t>> least_cost_assignment(const Eigen::MatrixXd& cost) {
  // NaN fails the comparison as well.
  if (!(cost.array() > -kInfinity).all()) {
    throw std::invalid_argument("assignment: a cost is NaN or -infinity");
  }
  std::vector<std::optional<std::size_t>> column_of_row(static_cast<std::size_t>(cost.rows()));
  if (cost.rows() <= cost.cols()) {
    const std::vector<std::size_t> columns = solved(cost);
    for (std::size_t row = 0; row < columns.size(); ++row) column_of_row[row] = columns[row];
    return column_of_row;
  }
  const std::vector<std::size_t> rows = solved(cost.transpose());
  for (std::size_t column = 0; column < rows.size(); ++column) column_of_row[rows[column]] = column;
  return column_of_row;
}

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
void solve_group(const std::vector<const GatedPair*>& pairs,
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
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(row_count, column_count + row_count, kInfinity);
  for (const GatedPair* pair : pairs) {
    cost(static_cast<Eigen::Index>(place_of(rows, pair->row)),
         static_cast<Eigen::Index>(place_of(columns, pair->column))) = pair->cost;
  }
  for (Eigen::Index row = 0; row < row_count; ++row) {
    cost(row, column_count + row) = alone_cost;
  }
  const auto solution = least_cost_assignment(cost);
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
  for (const auto& [group, own] : pairs_of_group) solve_group(own, alone_cost, column_of_row);
  return column_of_row;
}

}  // namespace airtruth::matching
