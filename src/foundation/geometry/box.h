// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <airtruth/box.h>

#include "foundation/geometry/transform.h"

namespace airtruth {

// The nearest whole number of pixels, clamped to +-1,000,000, which is far outside any picture. The
// clamp makes the conversion safe for a position or size from a file, which may be any number.
inline int whole_pixels(double px) {
  return static_cast<int>(std::round(std::clamp(px, -1e6, 1e6)));
}

// The smallest box of whole pixels that contains `box`. Edges are clamped to +-1,000,000 pixels,
// which is far outside any picture.
//
//   pixels_of({1.2, 0, 2.0, 1}) == {1, 0, 3, 1}
inline PixelBox pixels_of(const Box& box) {
  const int x = whole_pixels(std::floor(box.x));
  const int y = whole_pixels(std::floor(box.y));
  return {
      x, y, whole_pixels(std::ceil(box.right())) - x, whole_pixels(std::ceil(box.bottom())) - y};
}

inline bool is_finite(const Box& box) {
  return std::isfinite(box.x) && std::isfinite(box.y) && std::isfinite(box.width) &&
         std::isfinite(box.height);
}
// A box with a NaN or an infinity is none, as in the files of results.
inline std::optional<Box> if_finite(const std::optional<Box>& box) {
  return box && is_finite(*box) ? box : std::nullopt;
}

// Of two boxes of either kind, whose numbers are finite: std::max drops a NaN.
template <typename AnyBox = PixelBox>
std::optional<AnyBox> intersection(const AnyBox& a, const AnyBox& b) {
  const auto x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  const auto width = std::min(a.right(), b.right()) - x;
  const auto height = std::min(a.bottom(), b.bottom()) - y;
  if (!(width > 0 && height > 0)) return std::nullopt;
  return AnyBox{x, y, width, height};
}
template <typename AnyBox = PixelBox>
AnyBox bounds(const AnyBox& a, const AnyBox& b) {
  const auto x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.right(), b.right()) - x, std::max(a.bottom(), b.bottom()) - y};
}

// The number of pixels, and the index of one of them where they stand row by row.
inline std::size_t pixels_in(const PixelBox& box) {
  return static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height);
}
inline std::size_t index_in(const PixelBox& box, int x, int y) {
  return static_cast<std::size_t>(y - box.y) * static_cast<std::size_t>(box.width) +
         static_cast<std::size_t>(x - box.x);
}
inline std::size_t pixels_in(int width, int height) { return pixels_in({0, 0, width, height}); }
inline std::size_t index_in(int width, int x, int y) { return index_in({0, 0, width, 0}, x, y); }

// The number of pixels that both boxes cover.
inline std::int64_t common_px(const PixelBox& a, const PixelBox& b) {
  const auto common = intersection(a, b);
  return common ? std::int64_t{common->width} * common->height : 0;
}

inline Box as_box(const PixelBox& box) {
  return {double(box.x), double(box.y), double(box.width), double(box.height)};
}

inline Pixel centre_of(const Box& box) { return {box.x + box.width / 2, box.y + box.height / 2}; }

// The box with `margin_px` more on each side.
inline Box wider(const Box& box, double margin_px) {
  return {
      box.x - margin_px, box.y - margin_px, box.width + 2 * margin_px, box.height + 2 * margin_px};
}
inline PixelBox wider(const PixelBox& box, int margin_px) {
  return {
      box.x - margin_px, box.y - margin_px, box.width + 2 * margin_px, box.height + 2 * margin_px};
}

// The bounding box of points. It is empty before the first point.
class BoxBounds {
 public:
  void add(const Pixel& p) {
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
    any_ = true;
  }
  std::optional<Box> box() const {
    if (!any_) return std::nullopt;
    return Box{low_.x(), low_.y(), high_.x() - low_.x(), high_.y() - low_.y()};
  }

 private:
  Pixel low_ = Pixel::Constant(1e300);
  Pixel high_ = Pixel::Constant(-1e300);
  bool any_ = false;
};

}  // namespace airtruth
