// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/map_logarithm.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace airtruth::motion {
namespace {

// A length of about a picture's, in pixels: in its units the elements of a map are of one size. A
// power of two changes no digit of them.
constexpr double kUnitPx = 1024;

Homography in_units(const Homography& h, double unit_px) {
  const Vector3 units(unit_px, unit_px, 1);
  return units.cwiseInverse().asDiagonal() * h * units.asDiagonal();
}

// Norm up to which a series is summed, and its terms: what is left out is below 1e-17 of the sum.
constexpr double kSeriesNorm = 0.25;
constexpr int kExponentialTerms = 12;  // 0.25^13 / 13!
constexpr int kLogarithmTerms = 9;     // 2 (0.25 / 1.75)^19 / 19

// Steps towards a square root, whose error is squared by each, and roots of a map far from the
// identity: more have no end.
constexpr int kMostSteps = 40;
constexpr int kMostRoots = 40;
// Change by the last step, as a share: its square is far below a rounding.
constexpr double kLastChange = 1e-12;

const Homography kNone = Homography::Constant(std::numeric_limits<double>::quiet_NaN());

double distance_from_identity(const Homography& h) { return (h - Homography::Identity()).norm(); }

// Not finite where the steps do not converge: for negative eigenvalues.
Homography square_root(const Homography& h) {
  Homography root = h, inverse_root = Homography::Identity();
  for (int step = 0; step < kMostSteps; ++step) {
    const Homography next = 0.5 * (root + inverse_root.inverse());
    inverse_root = 0.5 * (inverse_root + root.inverse());
    const double change = (next - root).norm();
    root = next;
    if (change <= kLastChange * root.norm()) return root;
  }
  return kNone;
}

}  // namespace

Homography exponential(const Homography& logarithm) {
  const Homography all = in_units(logarithm, kUnitPx);
  if (!std::isfinite(all.norm())) return kNone;
  const int halvings = std::max(0, 1 + std::ilogb(all.norm() / kSeriesNorm));
  const Homography part = all * std::ldexp(1.0, -halvings);
  Homography term = Homography::Identity(), sum = term;
  for (int n = 1; n <= kExponentialTerms; ++n) sum += term = term * part / n;
  for (int i = 0; i < halvings; ++i) sum = Homography(sum * sum);
  return in_units(sum, 1 / kUnitPx);
}

// Near the identity log(H) = 2 artanh(z), with z = (H - I) (H + I)^-1.
Homography logarithm(const Homography& map) {
  Homography h = in_units(map, kUnitPx);
  int roots = 0;
  for (; distance_from_identity(h) > kSeriesNorm && roots < kMostRoots; ++roots) h = square_root(h);
  if (!(distance_from_identity(h) <= kSeriesNorm)) return kNone;
  const Homography z = (h - Homography::Identity()) * (h + Homography::Identity()).inverse();
  const Homography square = z * z;
  Homography power = z, sum = z;
  for (int n = 1; n < kLogarithmTerms; ++n) sum += (power = power * square) / (2 * n + 1);
  return in_units(sum * std::ldexp(2.0, roots), 1 / kUnitPx);
}

}  // namespace airtruth::motion
