// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "foundation/geometry/box.h"
#include "picture/render/renderer.h"

namespace airtruth::render {

// A quantity at the beginning, the middle and the end of a span of time; a parabola interpolates
// it.
template <typename T>
using Thrice = std::array<T, 3>;

// The value of the parabola at u, from -1 (beginning) to 1 (end).
template <typename T>
T between(const Thrice<T>& at, double u) {
  return T(at[1] + 0.5 * u * (at[2] - at[0]) + 0.5 * u * u * (at[2] - 2 * at[1] + at[0]));
}

// A span of time, in seconds from the frame's time.
struct Span {
  double begin_s = 0;
  double end_s = 0;
  bool is_instant() const { return !(end_s > begin_s); }
  // `k`: the index in a Thrice.
  double at(int k) const { return begin_s + 0.5 * k * (end_s - begin_s); }
  double u(double dt_s) const {
    return is_instant() ? 0 : 2 * (dt_s - begin_s) / (end_s - begin_s) - 1;
  }
};

// The span of the times of all samples of a patch.
Span span_of(const View& view, const PixelBox& patch);

// Directions in world at the corners of a patch's pixels; NaN where the lens has none. Inside a
// pixel the directions are interpolated: over one pixel a lens deviates from a plane by less than
// 1e-6 of the pixel's width.
class RayGrid {
 public:
  RayGrid(const View& view, const PixelBox& patch);

  // The direction of one point of the frame, at the frame's time.
  static Vector3 direction(const View& view, const Pixel& pixel);
  // The directions at a pixel's corners (0,0), (1,0), (0,1), (1,1). `moment` is the index 0, 1 or 2
  // in the patch's span; all three are equal where the span is an instant.
  std::array<Vector3, 4> corners(int x, int y, int moment = 1) const;
  const Span& span() const { return span_; }
  double exposure_s() const { return view_.shutter.exposure_s; }
  // True where all pixels of a row have one time.
  bool reads_rows() const {
    const Shutter& shutter = view_.shutter;
    return shutter.readout_s <= 0 || shutter.readout == Readout::kDown ||
           shutter.readout == Readout::kUp;
  }
  // The middle of the exposure of a pixel's row.
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
  // For an instant only the middle one is filled.
  Thrice<std::vector<Vector3>> directions_;
};

}  // namespace airtruth::render
