// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "foundation/geometry/box.h"
#include "picture/render/renderer.h"

namespace airtruth::render {

// Something at the beginning, middle and end of a span of time, and by a parabola between.
template <typename T>
using Thrice = std::array<T, 3>;

// u from -1 (beginning) to 1 (end).
template <typename T>
T between(const Thrice<T>& at, double u) {
  return T(at[1] + 0.5 * u * (at[2] - at[0]) + 0.5 * u * u * (at[2] - 2 * at[1] + at[0]));
}

// Seconds from the frame's time.
struct Span {
  double begin_s = 0;
  double end_s = 0;
  bool is_instant() const { return !(end_s > begin_s); }
  double at(int k) const { return begin_s + 0.5 * k * (end_s - begin_s); }  // k of Thrice
  double u(double dt_s) const {
    return is_instant() ? 0 : 2 * (dt_s - begin_s) / (end_s - begin_s) - 1;
  }
};

// When the samples of a patch are taken, and those of one of its pixels.
Span span_of(const View& view, const PixelBox& patch);

// Directions in world at the corners of a patch's pixels; NaN where the lens has none. Inside a
// pixel they are interpolated: over one pixel a lens is a plane to better than 1e-6 of its width.
class RayGrid {
 public:
  RayGrid(const View& view, const PixelBox& patch);

  // Of one point of the frame, at the frame's time.
  static Vector3 direction(const View& view, const Pixel& pixel);
  // Of a pixel: at (0,0), (1,0), (0,1), (1,1). `moment` 0, 1, 2 of the patch's span; where the span
  // is an instant they are the same.
  std::array<Vector3, 4> corners(int x, int y, int moment = 1) const;
  const Span& span() const { return span_; }
  double exposure_s() const { return view_.shutter.exposure_s; }
  // Middle of the exposure of a pixel's row.
  double middle_s(int x, int y) const {
    return view_.shutter.middle_s({double(x), double(y)}, view_.width, view_.height);
  }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }
  void fill(const View& view, int moment);

  View view_;
  PixelBox patch_;
  Span span_;
  int width_;
  Thrice<std::vector<Vector3>> directions_;  // for an instant the middle one alone
};

}  // namespace airtruth::render
