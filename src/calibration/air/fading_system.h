// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Cholesky>

#include "calibration/air/sky_curve.h"

// The equations of same_ground.h for one channel and one extinction.
namespace airtruth::calibration {

// The unknowns of one channel: the airlight of each sector, the mean light of the ground, and the
// relative change of contrast among squares at the range kMixedRange, which grows with the range
// squared.
constexpr int kMean = kSectors, kMixed = kSectors + 1, kUnknowns = kSectors + 2;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// One channel of a square in a view, or of a band of far ground.
struct Row {
  int square = 0, sector = 0;
  double range = 0, light = 0;
  // `contrast` is used for squares alone: their own light minus the mean.
  double weight = 1, contrast = 0;
};

// Weighted least squares for one extinction. The squares' own light is eliminated, since each
// occurs only in the rows of its own square.
struct System {
  struct Square {
    double tt = 0, ty = 0;
    Unknowns ta = Unknowns::Zero();
  };
  std::vector<Square> squares;
  Normal aa = Normal::Zero();
  Unknowns ay = Unknowns::Zero();
  double yy = 0;

  // Adds the prior that `unknown` is `value`, with the relative error `trust`.
  void expect(int unknown, double value, double trust);
  // Adds a square in a view, and a band of far ground; `t` is the share of its light that arrives.
  void add_square(const Row& row, double t);
  void add_far(const Row& row, double t, double mean_light);
  // Eliminates the squares' own light. It is called once, after all squares were added.
  void eliminate_own_light();

  Unknowns solution() const { return aa.ldlt().solve(ay); }
  double cost() const { return yy - ay.dot(solution()); }
  Unknowns sigma() const { return aa.ldlt().solve(Normal::Identity()).diagonal().cwiseSqrt(); }
  std::vector<double> own_light() const {
    const Unknowns x = solution();
    std::vector<double> own;
    for (const Square& q : squares) own.push_back(q.tt > 0 ? (q.ty - q.ta.dot(x)) / q.tt : 0);
    return own;
  }
};

}  // namespace airtruth::calibration
