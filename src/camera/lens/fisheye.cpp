// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "camera/lens/models.h"

namespace airtruth::lens {
namespace {

double curve(const Fisheye& lens, double theta) {
  const double t2 = theta * theta;
  const auto& k = lens.distortion;
  return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

double slope(const Fisheye& lens, double theta) {
  const double t2 = theta * theta;
  const auto& k = lens.distortion;
  return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
}

// The theta in [0, limit] with curve(theta) = radius. Newton's method runs within a shrinking
// bracket. Bisection replaces a step that does not halve the bracket, because Newton's method may
// circle around a bend of the curve.
double inverse(const Fisheye& lens, double radius, double limit) {
  double low = 0;
  double high = limit;
  double theta = std::min(radius, limit);
  double last_step = HUGE_VAL;
  for (int i = 0; i < 100; ++i) {
    const double miss = curve(lens, theta) - radius;
    if (miss == 0) return theta;
    (miss > 0 ? high : low) = theta;
    double next = theta - miss / slope(lens, theta);
    if (!(next >= low && next <= high) || std::abs(next - theta) > 0.5 * last_step)
      next = 0.5 * (low + high);
    last_step = std::abs(next - theta);
    if (last_step < 1e-15 * (1 + theta)) return next;
    theta = next;
  }
  return theta;
}

// The largest angle up to which the curve rises everywhere.
double max_angle(const Fisheye& lens) {
  constexpr int kSteps = 20000;
  for (int i = 1; i <= kSteps; ++i) {
    const double theta = kPi * i / kSteps;
    if (slope(lens, theta) > kFlat) continue;
    double low = kPi * (i - 1) / kSteps;
    double high = theta;
    for (int n = 0; n < 60; ++n) {
      const double middle = 0.5 * (low + high);
      (slope(lens, middle) > kFlat ? low : high) = middle;
    }
    return low;
  }
  return kPi;
}

}  // namespace

Field field_of(const Fisheye& lens) {
  const double angle = std::min(max_angle(lens), lens.stated_max_angle_rad);
  return {angle, curve(lens, angle) * (1 + 1e-12)};
}

std::optional<Pixel> project(const Fisheye& lens, const Vector3& p, const Field& field) {
  const double side = std::hypot(p.x(), p.y());
  const double theta = std::atan2(side, p.z());
  if (!(p.squaredNorm() > 0) || !(theta <= field.max_angle_rad)) return std::nullopt;
  if (side == 0) {
    // A point straight behind the camera has no direction from the axis, and so no unique pixel.
    if (p.z() < 0) return std::nullopt;
    return lens.principal_point_px;
  }
  const double scale = curve(lens, theta) / side;
  return Pixel(lens.focal_px.x() * scale * p.x() + lens.principal_point_px.x(),
               lens.focal_px.y() * scale * p.y() + lens.principal_point_px.y());
}

std::optional<Vector3> unproject(const Fisheye& lens, const Pixel& pixel, const Field& field) {
  const Pixel d = (pixel - lens.principal_point_px).cwiseQuotient(lens.focal_px);
  const double radius = d.norm();
  if (radius == 0) return Vector3(0, 0, 1);
  if (!(radius <= field.max_radius)) return std::nullopt;
  const double theta = inverse(lens, radius, field.max_angle_rad);
  const double scale = std::sin(theta) / radius;
  return Vector3(scale * d.x(), scale * d.y(), std::cos(theta));
}

}  // namespace airtruth::lens
