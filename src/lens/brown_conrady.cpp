// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "lens/models.h"

namespace airtruth::lens {
namespace {

// OpenCV's order: k1 k2 p1 p2 k3 k4 k5 k6.
std::array<double, 8> coefficients(const BrownConrady& lens) {
  std::array<double, 8> k{};
  for (std::size_t i = 0; i < lens.distortion.size() && i < 8; ++i) k[i] = lens.distortion[i];
  return k;
}

struct Distorted {
  Pixel value;
  Eigen::Matrix2d jacobian;
};

Distorted distort(const std::array<double, 8>& k, const Pixel& n) {
  const double x = n.x();
  const double y = n.y();
  const double r2 = x * x + y * y;
  const double up = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double down = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double radial = up / down;
  const double up_slope = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);
  const double down_slope = k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]);
  const double radial_slope =
      (up_slope * down - up * down_slope) / (down * down);  // d radial / d r2
  Distorted d;
  d.value = {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
             y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
  d.jacobian << radial + 2 * x * x * radial_slope + 2 * k[2] * y + 6 * k[3] * x,
      2 * x * y * radial_slope + 2 * k[2] * x + 2 * k[3] * y,
      2 * x * y * radial_slope + 2 * k[2] * x + 2 * k[3] * y,
      radial + 2 * y * y * radial_slope + 6 * k[2] * y + 2 * k[3] * x;
  return d;
}

// The radial part alone and its slope, over r = tan(angle).
double radial_slope_at(const std::array<double, 8>& k, double r) {
  const std::array<double, 8> radial = {k[0], k[1], 0, 0, k[4], k[5], k[6], k[7]};
  return distort(radial, {r, 0}).jacobian(0, 0);
}

double denominator(const std::array<double, 8>& k, double r) {
  const double r2 = r * r;
  return 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
}

// The tangential terms tilt the curve: the valid field ends where the map folds in any direction.
bool folds(const std::array<double, 8>& k, double r) {
  if (radial_slope_at(k, r) <= 0 || denominator(k, r) <= 0) return true;
  constexpr int kDirections = 32;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * kPi * i / kDirections;
    if (distort(k, {r * std::cos(angle), r * std::sin(angle)}).jacobian.determinant() <= 0)
      return true;
  }
  return false;
}

}  // namespace

double max_angle(const BrownConrady& lens) {
  const auto k = coefficients(lens);
  constexpr int kSteps = 4000;
  constexpr double kLimit = kPi / 2 - 1e-3;  // tan() beyond is of no use to any image
  for (int i = 1; i <= kSteps; ++i) {
    if (!folds(k, std::tan(kLimit * i / kSteps))) continue;
    double low = kLimit * (i - 1) / kSteps;
    double high = kLimit * i / kSteps;
    for (int n = 0; n < 50; ++n) {
      const double middle = 0.5 * (low + high);
      (folds(k, std::tan(middle)) ? high : low) = middle;
    }
    return low;
  }
  return kLimit;
}

std::optional<Pixel> project(const BrownConrady& lens, const Vector3& p, double max_angle_rad) {
  if (!(p.z() > 0)) return std::nullopt;
  if (!(std::atan2(std::hypot(p.x(), p.y()), p.z()) <= max_angle_rad)) return std::nullopt;
  const Pixel d = distort(coefficients(lens), {p.x() / p.z(), p.y() / p.z()}).value;
  return Pixel(d.cwiseProduct(lens.focal_px) + lens.principal_point_px);
}

std::optional<Vector3> unproject(const BrownConrady& lens,
                                 const Pixel& pixel,
                                 double max_angle_rad) {
  const auto k = coefficients(lens);
  const Pixel target = (pixel - lens.principal_point_px).cwiseQuotient(lens.focal_px);
  const double limit = std::tan(max_angle_rad);
  Pixel n = target.norm() > limit ? Pixel(target * (0.9 * limit / target.norm())) : target;
  double miss = (distort(k, n).value - target).norm();
  for (int i = 0; i < 100; ++i) {
    const Distorted d = distort(k, n);
    const Pixel full_step = d.jacobian.fullPivLu().solve(target - d.value);
    double share = 1;  // halve a step that leaves the valid field or makes things worse
    Pixel next = n;
    double next_miss = miss;
    for (int half = 0; half < 40; ++half, share *= 0.5) {
      next = n + share * full_step;
      next_miss = (distort(k, next).value - target).norm();
      if (next.norm() <= limit * (1 + 1e-9) && next_miss <= miss) break;
    }
    const bool still = (next - n).norm() <= 1e-15 * (1 + n.norm());
    n = next;
    miss = next_miss;
    if (still || miss == 0) break;
  }
  if (!(miss <= 1e-11 * (1 + target.norm())) || !(n.norm() <= limit * (1 + 1e-9)))
    return std::nullopt;
  return Vector3(n.x(), n.y(), 1).normalized();
}

}  // namespace airtruth::lens
