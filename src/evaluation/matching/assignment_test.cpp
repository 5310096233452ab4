// SPDX-License-Identifier: Apache-2.0
#include "evaluation/matching/assignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace airtruth::matching {
namespace {

using Columns = std::vector<std::optional<std::size_t>>;
constexpr double kForbidden = std::numeric_limits<double>::infinity();
constexpr auto kNoColumn = std::nullopt;

Eigen::MatrixXd matrix(std::initializer_list<std::initializer_list<double>> rows) {
  Eigen::MatrixXd m(rows.size(), rows.begin()->size());
  Eigen::Index row = 0;
  for (const auto& values : rows) {
    Eigen::Index column = 0;
    for (const double value : values) m(row, column++) = value;
    ++row;
  }
  return m;
}

double total(const Eigen::MatrixXd& cost, const Columns& columns) {
  double sum = 0;
  for (std::size_t row = 0; row < columns.size(); ++row) {
    if (columns[row]) {
      sum += cost(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(*columns[row]));
    }
  }
  return sum;
}

// The least total over every order of the columns; rows <= columns.
double least_by_trying_all(const Eigen::MatrixXd& cost) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(cost.cols()));
  std::iota(order.begin(), order.end(), 0);
  double least = kForbidden;
  do {
    double sum = 0;
    for (Eigen::Index row = 0; row < cost.rows(); ++row) {
      sum += cost(row, order[static_cast<std::size_t>(row)]);
    }
    least = std::min(least, sum);
  } while (std::ranges::next_permutation(order).found);
  return least;
}

TEST(Assignment, TheExampleOfTheHeader) {
  EXPECT_EQ(least_cost_assignment(matrix({{4, 1, 3}, {2, 0, 5}})), (Columns{1, 0}));
}

TEST(Assignment, IsTheLeastOfAll) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-5, 5);
  for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 5}, {3, 3}, {3, 6}, {5, 5}, {6, 7}}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::MatrixXd cost =
          Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return value(random); });
      const double least = least_by_trying_all(cost);
      EXPECT_NEAR(total(cost, least_cost_assignment(cost)), least, 1e-12);
      const Eigen::MatrixXd tall = cost.transpose();
      const Columns of_tall = least_cost_assignment(tall);
      EXPECT_NEAR(total(tall, of_tall), least, 1e-12);
      EXPECT_EQ(std::ranges::count_if(of_tall, [](const auto& c) { return c.has_value(); }), rows);
    }
  }
}

// The columns are those that linear_sum_assignment of SciPy 1.10.1 returned.
TEST(Assignment, ChoosesAmongEqualTotalsAsScipyDoes) {
  EXPECT_EQ(least_cost_assignment(matrix({{0, 1, 1, 0}, {1, 1, 1, 2}, {1, 0, 1, 1}, {2, 0, 0, 1}})),
            (Columns{3, 0, 1, 2}));
  EXPECT_EQ(least_cost_assignment(matrix({{1, 0, 1, 0, 1}, {1, 1, 0, 1, 0}, {0, 0, 1, 0, 1}})),
            (Columns{1, 2, 0}));
  EXPECT_EQ(least_cost_assignment(matrix({{0, 0, 1}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 1, 0}})),
            (Columns{0, 1, kNoColumn, kNoColumn, 2}));
  EXPECT_EQ(least_cost_assignment(matrix({{3, 0, 1, 1, 0, 1},
                                          {1, 1, 3, 2, 2, 2},
                                          {2, 3, 0, 1, 1, 1},
                                          {3, 0, 0, 2, 1, 0},
                                          {0, 3, 2, 2, 2, 3},
                                          {3, 2, 1, 0, 0, 1}})),
            (Columns{4, 1, 2, 5, 0, 3}));
  EXPECT_EQ(least_cost_assignment(matrix({{1, 1, 2, 1},
                                          {2, 2, 2, 2},
                                          {2, 0, 0, 0},
                                          {2, 2, 1, 2},
                                          {0, 2, 1, 1},
                                          {2, 0, 2, 1},
                                          {0, 0, 1, 0}})),
            (Columns{kNoColumn, kNoColumn, 2, kNoColumn, 0, 1, 3}));
}

TEST(Assignment, NothingToAssign) {
  EXPECT_EQ(least_cost_assignment(Eigen::MatrixXd(0, 3)), Columns{});
  EXPECT_EQ(least_cost_assignment(Eigen::MatrixXd(2, 0)), (Columns{kNoColumn, kNoColumn}));
}

TEST(Assignment, ForbiddenPairs) {
  EXPECT_EQ(least_cost_assignment(matrix({{kForbidden, 9}, {0, 1}})), (Columns{1, 0}));
  EXPECT_THROW(least_cost_assignment(matrix({{kForbidden, 9}, {kForbidden, 1}})),
               std::invalid_argument);
}

TEST(Assignment, RefusesWhatIsNoCost) {
  EXPECT_THROW(least_cost_assignment(matrix({{std::nan(""), 9}, {0, 1}})), std::invalid_argument);
  EXPECT_THROW(least_cost_assignment(matrix({{-kForbidden, 9}, {0, 1}})), std::invalid_argument);
}

TEST(GatedPairs, GroupsAreSolvedApart) {
  // Rows 0 and 1 compete for column 0, row 1 may have column 1; row 2 is alone with column 3.
  const auto columns = least_cost_pairs({{0, 0, 2}, {1, 0, 1}, {1, 1, 4}, {2, 3, 5}}, 4, 4, 10);
  EXPECT_EQ(columns, (std::vector<std::optional<std::size_t>>{0, 1, 3, std::nullopt}));
  // Where it is cheaper to remain alone, a row does.
  EXPECT_EQ(least_cost_pairs({{0, 0, 2}, {1, 0, 1}, {1, 1, 4}}, 2, 2, 2.5),
            (std::vector<std::optional<std::size_t>>{std::nullopt, 0}));
}

}  // namespace
}  // namespace airtruth::matching
