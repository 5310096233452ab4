// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "foundation/geometry/transform.h"

namespace airtruth::trajectory {

// A natural cubic spline (second derivative 0 at both ends) through points at strictly increasing
// knots; C2. Two points make a straight line. De Boor (1978), chapter IV.
template <typename Point>
class CubicSpline {
 public:
  CubicSpline(std::vector<double> knots, std::vector<Point> points);

  // Derivative 0, 1 or 2 at u, which is clamped to the knots' range.
  Point at(double u, int derivative) const;
  double begin() const { return knots_.front(); }
  double end() const { return knots_.back(); }
  const std::vector<double>& knots() const { return knots_; }

 private:
  std::vector<double> knots_;
  std::vector<Point> points_;
  std::vector<Point> curvature_;  // second derivatives at the knots
};

extern template class CubicSpline<Vector3>;

}  // namespace airtruth::trajectory
