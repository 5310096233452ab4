// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "foundation/geometry/transform.h"

namespace airtruth::trajectory {

// A natural cubic spline (C2, second derivative 0 at both ends) through points at strictly
// increasing knots. Two points make a straight line. Source: de Boor (1978), chapter IV.
class CubicSpline {
 public:
  CubicSpline(std::vector<double> knots, std::vector<Vector3> points);

  // The value (derivative 0) or the derivative 1 or 2 at u. A u outside the knots' range is clamped
  // to it.
  Vector3 at(double u, int derivative) const;
  double begin() const { return knots_.front(); }
  double end() const { return knots_.back(); }
  const std::vector<double>& knots() const { return knots_; }

 private:
  std::vector<double> knots_;
  std::vector<Vector3> points_;
  // Second derivatives at the knots.
  std::vector<Vector3> curvature_;
};

}  // namespace airtruth::trajectory
