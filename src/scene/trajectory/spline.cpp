// SPDX-License-Identifier: Apache-2.0
#include "scene/trajectory/spline.h"

#include <algorithm>

namespace airtruth::trajectory {
namespace {

// Second derivatives at the knots: the tridiagonal system of a continuous slope, solved by Thomas's
// algorithm.
std::vector<Vector3> second_derivatives(const std::vector<double>& t,
                                        const std::vector<Vector3>& p) {
  const std::size_t n = p.size();
  std::vector<Vector3> m(n, Vector3::Zero());
  if (n < 3) return m;
  std::vector<double> upper(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = t[i] - t[i - 1];
    const double after = t[i + 1] - t[i];
    const Vector3 right = 6.0 * ((p[i + 1] - p[i]) / after - (p[i] - p[i - 1]) / before);
    const double pivot = 2.0 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    m[i] = (right - before * m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 2; i > 0; --i) m[i] -= upper[i] * m[i + 1];
  return m;
}

}  // namespace

CubicSpline::CubicSpline(std::vector<double> knots, std::vector<Vector3> points)
    : knots_(std::move(knots)),
      points_(std::move(points)),
      curvature_(second_derivatives(knots_, points_)) {}

Vector3 CubicSpline::at(double u, int derivative) const {
  u = std::clamp(u, begin(), end());
  const auto after = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, u);
  const auto i = static_cast<std::size_t>(after - knots_.begin()) - 1;
  const double h = knots_[i + 1] - knots_[i];
  const double a = (knots_[i + 1] - u) / h;
  const double b = (u - knots_[i]) / h;
  if (derivative == 2) return a * curvature_[i] + b * curvature_[i + 1];
  if (derivative == 1) {
    return (points_[i + 1] - points_[i]) / h +
           h / 6.0 * ((3 * b * b - 1) * curvature_[i + 1] - (3 * a * a - 1) * curvature_[i]);
  }
  return a * points_[i] + b * points_[i + 1] +
         h * h / 6.0 * ((a * a * a - a) * curvature_[i] + (b * b * b - b) * curvature_[i + 1]);
}

}  // namespace airtruth::trajectory
