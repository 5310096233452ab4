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

// Rows are at most as many as columns. Each row in turn gets a column by the shortest path of
// reduced costs from the row to a free column.
class Solver {
 public:
  explicit Solver(const Eigen::MatrixXd& cost)
      : cost_(cost),
        rows_(static_cast<std::size_t>(cost.rows())),
        columns_(static_cast<std::size_t>(cost.cols())),
        row_dual_(rows_, 0.0),
        column_dual_(columns_, 0.0),
        column_of_row_(rows_, kNone),
        row_of_column_(columns_, kNone),
        path_cost_(columns_),
        path_row_(columns_, kNone),
        remaining_(columns_) {}

  std::vector<std::size_t> solve() {
    for (std::size_t row = 0; row < rows_; ++row) {
      const Path path = shortest_path(row);
      update_duals(row, path.cost);
      augment(row, path.free_column);
    }
    return column_of_row_;
  }

 private:
  struct Path {
    std::size_t free_column;
    double cost;
  };

  double cost(std::size_t row, std::size_t column) const {
    return cost_(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
  }

  // Dijkstra's search over columns. The order of remaining_ and the preference for a free column
  // decide among equal costs; the header promises scipy's choice.
  Path shortest_path(std::size_t row) {
    row_reached_.assign(rows_, false);
    column_reached_.assign(columns_, false);
    path_cost_.assign(columns_, kInfinity);
    for (std::size_t k = 0; k < columns_; ++k) remaining_[k] = columns_ - 1 - k;
    std::size_t left = columns_;
    double reached_cost = 0;
    while (true) {
      row_reached_[row] = true;
      const std::size_t nearest = relax(row, reached_cost, left);
      const std::size_t column = remaining_[nearest];
      reached_cost = path_cost_[column];
      if (reached_cost == kInfinity) {
        throw std::invalid_argument("assignment: the forbidden pairs leave no assignment");
      }
      column_reached_[column] = true;
      remaining_[nearest] = remaining_[--left];
      if (row_of_column_[column] == kNone) return {column, reached_cost};
      row = row_of_column_[column];
    }
  }

  // Updates the cheapest path to every remaining column by way of `row`. Returns the place in
  // remaining_ of the nearest one.
  std::size_t relax(std::size_t row, double reached_cost, std::size_t left) {
    std::size_t nearest = 0;
    double lowest = kInfinity;
    for (std::size_t k = 0; k < left; ++k) {
      const std::size_t column = remaining_[k];
      const double through =
          reached_cost + cost(row, column) - row_dual_[row] - column_dual_[column];
      if (through < path_cost_[column]) {
        path_cost_[column] = through;
        path_row_[column] = row;
      }
      if (path_cost_[column] < lowest ||
          (path_cost_[column] == lowest && row_of_column_[column] == kNone)) {
        lowest = path_cost_[column];
        nearest = k;
      }
    }
    return nearest;
  }

  void update_duals(std::size_t first_row, double path_cost) {
    row_dual_[first_row] += path_cost;
    for (std::size_t row = 0; row < rows_; ++row) {
      if (row_reached_[row] && row != first_row) {
        row_dual_[row] += path_cost - path_cost_[column_of_row_[row]];
      }
    }
    for (std::size_t column = 0; column < columns_; ++column) {
      if (column_reached_[column]) column_dual_[column] -= path_cost - path_cost_[column];
    }
  }

  void augment(std::size_t first_row, std::size_t column) {
    std::size_t row = kNone;
    while (row != first_row) {
      row = path_row_[column];
      row_of_column_[column] = row;
      std::swap(column_of_row_[row], column);
    }
  }

  const Eigen::MatrixXd& cost_;
  std::size_t rows_;
  std::size_t columns_;
  std::vector<double> row_dual_;
  std::vector<double> column_dual_;
  std::vector<std::size_t> column_of_row_;
  std::vector<std::size_t> row_of_column_;
  std::vector<double> path_cost_;
  std::vector<std::size_t> path_row_;
  std::vector<std::size_t> remaining_;
  std::vector<bool> row_reached_;
  std::vector<bool> column_reached_;
};

}  // namespace

std::vector<std::optional<std::size_t>> least_cost_assignment(const Eigen::MatrixXd& cost) {
  // NaN fails the comparison as well.
  if (!(cost.array() > -kInfinity).all()) {
    throw std::invalid_argument("assignment: a cost is NaN or -infinity");
  }
  std::vector<std::optional<std::size_t>> column_of_row(static_cast<std::size_t>(cost.rows()));
  if (cost.rows() <= cost.cols()) {
    const std::vector<std::size_t> columns = Solver(cost).solve();
    for (std::size_t row = 0; row < columns.size(); ++row) column_of_row[row] = columns[row];
    return column_of_row;
  }
  const Eigen::MatrixXd transposed = cost.transpose();
  const std::vector<std::size_t> rows = Solver(transposed).solve();
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
  for (const auto& [group, own] : pairs_of_group) solve(own, alone_cost, column_of_row);
  return column_of_row;
}

}  // namespace airtruth::matching
