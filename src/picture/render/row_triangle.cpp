// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "picture/render/sides.h"

namespace airtruth::render {
namespace {

// Covers the rounding of a triangle's place.
constexpr double kRowMarginPx = 0.02;

// The range of x of the part of a triangle between two values of y; the first is larger than the
// second where there is none.
std::pair<double, double> across_band(const std::array<Pixel, 3>& corner, double low, double high) {
  double left = std::numeric_limits<double>::infinity();
  double right = -left;
  const auto add = [&](double x) {
    left = std::min(left, x);
    right = std::max(right, x);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel& a = corner[k];
    const Pixel& b = corner[(k + 1) % 3];
    if (a.y() >= low && a.y() <= high) add(a.x());
    for (const double y : {low, high})
      if ((a.y() < y) != (b.y() < y)) add(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  return {left, right};
}

}  // namespace

RowTriangle MovingTriangle::over_row(int y, double u) const {
  const Now now = this->now({0, y, u});
  const std::array<Pixel, 3>& p = now.corner;
  RowTriangle row;
  const double spread = now.spread_px();
  const double reach_y = std::abs(now.drift.y()) + spread + kRowMarginPx;
  const double area = across(p[1] - p[0], p[2] - p[0]);
  const auto [left, right] = across_band(p, -reach_y, 1 + reach_y);
  row.is_outside = area == 0 || left > right;
  if (row.is_outside) return row;
  row.left = left;
  row.right = right;
  const auto [top, bottom] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
  row.top = static_cast<float>(top);
  row.bottom = static_cast<float>(bottom);
  row.drift_x = static_cast<float>(now.drift.x());
  row.drift_y = static_cast<float>(now.drift.y());
  row.spread = static_cast<float>(spread);
  const double sign = area > 0 ? 1 : -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel inward = sign * inward_of(p[k], p[(k + 1) % 3]);
    const double drifts = inward.dot(now.drift_of_side(k));
    row.side[k] = {drifts - inward.dot(p[k]),
                   inward.x(),
                   static_cast<float>(inward.y()),
                   static_cast<float>(-2 * drifts)};
  }
  if (!has_depth_) return row;
  const DepthPlane plane = depth_plane(u, p, now.drift, area);
  row.nearness = {plane.at_corner,
                  plane.slope.x(),
                  static_cast<float>(plane.slope.y()),
                  static_cast<float>(plane.per_time)};
  row.farthest_depth = plane.farthest;
  row.nearest_depth = plane.nearest;
  return row;
}

PixelSides RowTriangle::over(int x, PixelDepth* depth) const {
  const auto at = [x](const Side& of) {
    return Straight{static_cast<float>(of.at_start + of.per_x * x),
                    static_cast<float>(of.per_x),
                    of.per_y,
                    of.per_time};
  };
  PixelSides result;
  for (const Side& of : side)
    if (!add_side(at(of), result)) return result;
  const double reach = std::abs(static_cast<double>(drift_x)) + static_cast<double>(spread);
  result.strips = strips_between(left - reach - x, right + reach - x);
  if (depth != nullptr) *depth = {at(nearness), farthest_depth, nearest_depth};
  return result;
}

std::pair<int, int> RowTriangle::columns() const {
  if (is_outside) return {0, 0};
  const double reach =
      std::abs(static_cast<double>(drift_x)) + static_cast<double>(spread) + kRowMarginPx;
  return {static_cast<int>(std::floor(left - reach)), static_cast<int>(std::ceil(right + reach))};
}

}  // namespace airtruth::render
