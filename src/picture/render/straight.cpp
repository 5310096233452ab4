// SPDX-License-Identifier: Apache-2.0
#include "picture/render/straight.h"

#include <algorithm>
#include <cmath>

namespace airtruth::render {
namespace {

// Beyond this distance from the frame's corner single precision no longer suffices.
constexpr double kFarPx = 1e5;
// A side shorter than this many pixels counts as straight under any lens: an arc of 100 px radius
// deviates from a chord of that length by 1/800 px.
constexpr double kStraightPx = 1;
// A fraction of the distance between samples.
constexpr double kNegligiblePx = 0.004;

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

// The strips between two places in the pixel.
unsigned strips_between(double low, double high) {
  // Covers the rounding of the samples' places.
  constexpr double kMargin = 1e-5;
  const auto strip = [](double x) {
    return std::clamp(
        static_cast<int>(std::floor(x * PixelSamples::kStrips)), 0, PixelSamples::kStrips - 1);
  };
  const unsigned up_to = (2U << strip(std::clamp(high + kMargin, 0.0, 1.0))) - 1;
  return up_to & ~((1U << strip(std::clamp(low - kMargin, 0.0, 1.0))) - 1);
}

double across(const Pixel& a, const Pixel& b) { return a.x() * b.y() - a.y() * b.x(); }

// Perpendicular to a side, towards the inside of a triangle whose corners are in the order of a
// positive area.
Pixel inward_of(const Pixel& from, const Pixel& to) {
  return {from.y() - to.y(), to.x() - from.x()};
}

// Adds a side that crosses the pixel. Returns false where the whole pixel is outside.
bool add_side(const Straight& side, PixelSides& sides) {
  const float low = std::min(0.0f, side.b) + std::min(0.0f, side.c) + std::min(0.0f, side.d);
  const float high = std::max(0.0f, side.b) + std::max(0.0f, side.c) + std::max(0.0f, side.d);
  sides.is_outside = side.a + high < 0;
  if (sides.is_outside) return false;
  if (side.a + low < 0) sides.side[static_cast<std::size_t>(sides.crossing++)] = side;
  return true;
}

}  // namespace

std::optional<StraightTriangle> StraightTriangle::of(const std::vector<Corners>& corners,
                                                     const std::vector<Eye>& eyes,
                                                     double exposure_share) {
  for (std::size_t e = 0; e < eyes.size(); ++e)
    if (!is_near(corners[e]) || !(eyes[e].is_pinhole() || extent_px(corners[e]) <= kStraightPx))
      return std::nullopt;
  StraightTriangle triangle;
  triangle.moves_ = eyes.size() == 3;
  if (!triangle.moves_) {
    for (std::size_t k = 0; k < 3; ++k)
      triangle.corner_[k] = {corners[0][k]->pixel, Pixel::Zero(), Pixel::Zero()};
    triangle.stand_still();
    return triangle;
  }
  triangle.half_ = exposure_share;
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel first = corners[0][k]->pixel;
    const Pixel middle = corners[1][k]->pixel;
    const Pixel last = corners[2][k]->pixel;
    triangle.corner_[k] = {middle, 0.5 * (last - first), 0.5 * (last - 2 * middle + first)};
    const double bend = largest(triangle.corner_[k][2]);
    // The next term of the series, where each is smaller than the one before by one factor.
    const double next = bend * bend / largest(triangle.corner_[k][1]);
    const double bend_in_exposure = exposure_share * exposure_share * bend;
    if (bend > kNegligiblePx && !(bend_in_exposure <= kNegligiblePx && next <= kNegligiblePx))
      return std::nullopt;
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (exposure_share * largest(triangle.corner_[k][1] - triangle.corner_[(k + 1) % 3][1]) >
        kNegligiblePx)
      return std::nullopt;
  return triangle;
}

void StraightTriangle::stand_still() {
  const Pixel a = corner_[0][0];
  const Pixel b = corner_[1][0];
  const Pixel c = corner_[2][0];
  left_ = std::min({a.x(), b.x(), c.x()});
  right_ = std::max({a.x(), b.x(), c.x()});
  const double area = across(b - a, c - a);
  const std::array<Pixel, 4> corners =
      area > 0 ? std::array<Pixel, 4>{a, b, c, a} : std::array<Pixel, 4>{a, c, b, a};
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel inward = inward_of(corners[k], corners[k + 1]);
    line_[k] = {-inward.dot(corners[k]), inward.x(), inward.y()};
  }
  // A triangle that is seen edge-on is outside everywhere.
  if (area == 0) line_[0] = {-1, 0, 0};
}

PixelSides StraightTriangle::over(int x, int y, double u) const {
  if (moves_) return over_moving(x, y, u);
  PixelSides result;
  for (const Line& line : line_) {
    const Straight side{static_cast<float>(line.at_origin + line.per_x * x + line.per_y * y),
                        static_cast<float>(line.per_x),
                        static_cast<float>(line.per_y),
                        0};
    if (!add_side(side, result)) return result;
  }
  result.strips = strips_between(left_ - x, right_ - x);
  return result;
}

PixelSides StraightTriangle::over_moving(int x, int y, double u) const {
  PixelSides result;
  std::array<Pixel, 3> p;
  Pixel drift(0, 0);
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = corner_[k][0] - Pixel(x, y) + u * (corner_[k][1] + u * corner_[k][2]);
    drift += half_ / 3 * (corner_[k][1] + 2 * u * corner_[k][2]);
  }
  const Pixel reach = drift.cwiseAbs();
  const Pixel low = p[0].cwiseMin(p[1]).cwiseMin(p[2]) - reach;
  const Pixel high = p[0].cwiseMax(p[1]).cwiseMax(p[2]) + reach;
  const double area = across(p[1] - p[0], p[2] - p[0]);
  result.is_outside = low.maxCoeff() > 1 || high.minCoeff() < 0 || area == 0;
  if (result.is_outside) return result;
  if (area < 0) std::swap(p[1], p[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Pixel inward = inward_of(p[k], p[(k + 1) % 3]);
    const double drifts = inward.dot(drift);
    const Straight side{static_cast<float>(drifts - inward.dot(p[k])),
                        static_cast<float>(inward.x()),
                        static_cast<float>(inward.y()),
                        static_cast<float>(-2 * drifts)};
    if (!add_side(side, result)) return result;
  }
  result.strips = strips_between(low.x(), high.x());
  return result;
}

}  // namespace airtruth::render
