// SPDX-License-Identifier: Apache-2.0
#include "picture/render/straight.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "picture/render/sides.h"

namespace airtruth::render {
namespace {

// Beyond this distance from the frame's corner single precision no longer suffices.
constexpr double kFarPx = 1e5;

bool is_near(const Corners& corners) {
  return std::all_of(corners.begin(), corners.end(), [](const Seen* corner) {
    return corner->pixel.allFinite() && corner->pixel.cwiseAbs().maxCoeff() < kFarPx;
  });
}

double extent_px(const Corners& c) {
  const Pixel low = c[0]->pixel.cwiseMin(c[1]->pixel).cwiseMin(c[2]->pixel);
  const Pixel high = c[0]->pixel.cwiseMax(c[1]->pixel).cwiseMax(c[2]->pixel);
  return (high - low).maxCoeff();
}

double largest(const Pixel& v) { return v.cwiseAbs().maxCoeff(); }

// The coefficients of 1, u and u^2 of the parabola of between() in ray_grid.h.
template <typename T>
Thrice<T> coefficients(const T& first, const T& middle, const T& last) {
  return {middle, 0.5 * (last - first), 0.5 * (last - 2 * middle + first)};
}

// A side that passes through two corners of a triangle seen edge-on excludes everything.
constexpr double kNowhere = -1;

}  // namespace

std::optional<StillTriangle> StillTriangle::of(const Corners& corners,
                                               const Eye& eye,
                                               const Tolerance& tolerance) {
  if (!is_near(corners) || !(eye.is_pinhole() || extent_px(corners) <= tolerance.size_px))
    return std::nullopt;
  StillTriangle triangle;
  const Pixel a = corners[0]->pixel;
  const Pixel b = corners[1]->pixel;
  const Pixel c = corners[2]->pixel;
  triangle.left_ = std::min({a.x(), b.x(), c.x()});
  triangle.right_ = std::max({a.x(), b.x(), c.x()});
  const double area = across(b - a, c - a);
  // A triangle that is seen edge-on is outside everywhere.
  if (area == 0) triangle.lines_.at_origin[0] = kNowhere;
  if (area == 0) return triangle;
  const double sign = area > 0 ? 1 : -1;
  Lines& lines = triangle.lines_;
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel from = corners[(k + 1) % 3]->pixel;
    const Pixel inward = sign * inward_of(from, corners[(k + 2) % 3]->pixel);
    lines.at_origin[k] = -inward.dot(from);
    lines.per_x[k] = inward.x();
    lines.per_y[k] = inward.y();
    const double share = corners[k]->nearness / std::abs(area);
    triangle.nearness_[k] = static_cast<float>(corners[k]->nearness);
    lines.at_origin[kDepth] += share * lines.at_origin[k];
    lines.per_x[kDepth] += share * lines.per_x[k];
    lines.per_y[kDepth] += share * lines.per_y[k];
  }
  return triangle;
}

PixelSides StillTriangle::over(const PixelPlace& pixel, PixelDepth* depth) const {
  const PixelLines lines = lines_.over(pixel);
  // The tests of add_side(), for all lines at once.
  std::array<float, 4> highest;
  std::array<float, 4> lowest;
  for (std::size_t k = 0; k < 4; ++k) {
    const float per_x = lines.per_x[k];
    const float per_y = lines.per_y[k];
    highest[k] = lines.at_corner[k] + (std::max(0.0F, per_x) + std::max(0.0F, per_y));
    lowest[k] = lines.at_corner[k] + (std::min(0.0F, per_x) + std::min(0.0F, per_y));
  }
  PixelSides result;
  result.is_outside = highest[0] < 0 || highest[1] < 0 || highest[2] < 0;
  if (result.is_outside) return result;
  for (std::size_t k = 0; k < 3; ++k)
    if (lowest[k] < 0) result.side[static_cast<std::size_t>(result.crossing++)] = lines.line(k);
  result.strips = strips_between(left_ - pixel.x, right_ - pixel.x);
  if (depth != nullptr) *depth = depth_of(lines);
  return result;
}

PixelDepth StillTriangle::depth_over(const PixelPlace& pixel) const {
  return depth_of(lines_.over(pixel));
}

std::array<float, 2> StillTriangle::weights_at(const PixelPlace& pixel,
                                               const std::array<float, 3>& place) const {
  const PixelLines lines = lines_.over(pixel);
  std::array<float, 3> weight;
  for (std::size_t k = 0; k < 3; ++k) {
    const Straight side = lines.line(k);
    // Equal steps in the picture are not equal steps on the surface.
    weight[k] = std::max(0.0F, side.a + side.b * place[0] + side.c * place[1]) * nearness_[k];
  }
  const float sum = weight[0] + weight[1] + weight[2];
  return {weight[1] / sum, weight[2] / sum};
}

std::optional<MovingTriangle> MovingTriangle::of(const std::vector<Corners>& corners,
                                                 const std::vector<Eye>& eyes,
                                                 double exposure_share,
                                                 const Tolerance& tolerance) {
  const double most_px = tolerance.motion_px;
  for (std::size_t e = 0; e < eyes.size(); ++e)
    if (!is_near(corners[e]) ||
        !(eyes[e].is_pinhole() || extent_px(corners[e]) <= tolerance.size_px))
      return std::nullopt;
  MovingTriangle triangle;
  triangle.has_depth_ = true;
  triangle.half_ = exposure_share;
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.corner_[k] =
        coefficients(corners[0][k]->pixel, corners[1][k]->pixel, corners[2][k]->pixel);
    triangle.nearness_[k] =
        coefficients(corners[0][k]->nearness, corners[1][k]->nearness, corners[2][k]->nearness);
    for (const Corners& of : corners) {
      triangle.has_depth_ = triangle.has_depth_ && of[k]->nearness > 0;
      triangle.nearest_ = std::max(triangle.nearest_, static_cast<float>(of[k]->nearness));
    }
    const double bend = largest(triangle.corner_[k][2]);
    // The next term of the series, where each is smaller than the one before by one factor.
    const double next = bend * bend / largest(triangle.corner_[k][1]);
    // A parabola s^2 t^2, with t from -1 to 1, is at most 2/3 s^2 from its mean.
    const double left_out_px = 2.0 / 3 * exposure_share * exposure_share * bend;
    if (bend > most_px && !(left_out_px <= most_px && next <= most_px)) return std::nullopt;
  }
  // At the end of the exposure a corner is half of the difference from where its side puts it.
  for (std::size_t k = 0; k < 3; ++k)
    if (0.5 * exposure_share * largest(triangle.corner_[k][1] - triangle.corner_[(k + 1) % 3][1]) >
        most_px)
      return std::nullopt;
  return triangle;
}

double MovingTriangle::Now::spread_px() const {
  // The largest distance of a corner from the middle's motion, along one axis. The lines of two
  // sides of an acute corner meet up to as far again from it.
  double most = 0;
  for (const Pixel& of : drift_of) most = std::max(most, largest(of - drift));
  return 2 * most;
}

MovingTriangle::Now MovingTriangle::now(const PixelPlace& pixel) const {
  Now now;
  const double u = pixel.u;
  now.drift = Pixel::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Thrice<Pixel>& p = corner_[k];
    // The mean of u^2 over an exposure is half_^2 / 3 more than its value in the middle.
    now.corner[k] =
        p[0] - Pixel(pixel.x, pixel.y) + u * (p[1] + u * p[2]) + half_ * half_ / 3 * p[2];
    now.drift_of[k] = half_ * (p[1] + 2 * u * p[2]);
    now.drift += now.drift_of[k] / 3;
  }
  return now;
}

PixelSides MovingTriangle::over(const PixelPlace& pixel, PixelDepth* depth) const {
  PixelSides result;
  const Now now = this->now(pixel);
  const std::array<Pixel, 3>& p = now.corner;
  const Pixel reach = now.drift.cwiseAbs() + Pixel::Constant(now.spread_px());
  const Pixel low = p[0].cwiseMin(p[1]).cwiseMin(p[2]);
  const Pixel high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
  result.is_outside = (low - reach).maxCoeff() > 1 || (high + reach).minCoeff() < 0;
  if (result.is_outside) return result;
  const double area = across(p[1] - p[0], p[2] - p[0]);
  result.is_outside = area == 0;
  if (result.is_outside) return result;
  const double sign = area > 0 ? 1 : -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel inward = sign * inward_of(p[k], p[(k + 1) % 3]);
    const double drifts = inward.dot(now.drift_of_side(k));
    const Straight side{static_cast<float>(drifts - inward.dot(p[k])),
                        static_cast<float>(inward.x()),
                        static_cast<float>(inward.y()),
                        static_cast<float>(-2 * drifts)};
    if (!add_side(side, result)) return result;
  }
  result.strips = strips_between(low.x() - reach.x(), high.x() + reach.x());
  if (depth != nullptr) *depth = depth_at(pixel.u, p, now.drift, area);
  return result;
}

PixelDepth MovingTriangle::depth_over(const PixelPlace& pixel) const {
  const Now now = this->now(pixel);
  const std::array<Pixel, 3>& p = now.corner;
  return depth_at(pixel.u, p, now.drift, across(p[1] - p[0], p[2] - p[0]));
}

MovingTriangle::DepthPlane MovingTriangle::depth_plane(double u,
                                                       const std::array<Pixel, 3>& corner,
                                                       const Pixel& drift,
                                                       double area) const {
  std::array<double, 3> at;
  double nearing = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    at[k] = nearness(k, u);
    nearing += half_ / 3 * (nearness_[k][1] + 2 * u * nearness_[k][2]);
  }
  const Pixel p = corner[1] - corner[0];
  const Pixel q = corner[2] - corner[0];
  const double rise_p = at[1] - at[0];
  const double rise_q = at[2] - at[0];
  const double scale = 1 / area;
  const Pixel slope(scale * (rise_p * q.y() - rise_q * p.y()),
                    scale * (rise_q * p.x() - rise_p * q.x()));
  const double over_time = nearing - slope.dot(drift);
  const double change = std::abs(nearing);
  return {at[0] - slope.dot(corner[0]) - over_time,
          slope,
          2 * over_time,
          static_cast<float>(std::min({at[0], at[1], at[2]}) - change),
          static_cast<float>(std::max({at[0], at[1], at[2]}) + change)};
}

PixelDepth MovingTriangle::depth_at(double u,
                                    const std::array<Pixel, 3>& corner,
                                    const Pixel& drift,
                                    double area) const {
  const DepthPlane plane = depth_plane(u, corner, drift, area);
  return {{static_cast<float>(plane.at_corner),
           static_cast<float>(plane.slope.x()),
           static_cast<float>(plane.slope.y()),
           static_cast<float>(plane.per_time)},
          plane.farthest,
          plane.nearest};
}

std::array<float, 2> MovingTriangle::weights_at(const PixelPlace& pixel,
                                                const std::array<float, 3>& place) const {
  const Now now = this->now(pixel);
  const std::array<Pixel, 3>& corner = now.corner;
  const Pixel here = Pixel(place[0], place[1]) - (2.0 * place[2] - 1) * now.drift;
  const double area = across(corner[1] - corner[0], corner[2] - corner[0]);
  std::array<double, 3> weight;
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel a = corner[(k + 1) % 3] - here;
    const Pixel b = corner[(k + 2) % 3] - here;
    weight[k] = std::max(0.0, across(a, b) / area) * nearness(k, pixel.u);
    sum += weight[k];
  }
  return {static_cast<float>(weight[1] / sum), static_cast<float>(weight[2] / sum)};
}

}  // namespace airtruth::render
