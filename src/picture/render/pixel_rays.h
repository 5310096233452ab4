// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "foundation/geometry/box.h"
#include "picture/render/renderer.h"

// The rays of a patch's pixels, and the times at which they are exposed.
namespace airtruth::render {

// A quantity at the beginning, the middle and the end of a span of time.
template <typename T>
using Thrice = std::array<T, 3>;

// The coefficients of 1, u and u^2 of the parabola through three values, with u from -1 (beginning)
// to 1 (end).
template <typename T>
Thrice<T> parabola(const Thrice<T>& at) {
  return {at[1], T(0.5 * (at[2] - at[0])), T(0.5 * (at[2] - 2 * at[1] + at[0]))};
}

// A span of time, in seconds from the frame's time.
struct Span {
  double begin_s = 0;
  double end_s = 0;
  bool is_instant() const { return !(end_s > begin_s); }
  double middle_s() const { return 0.5 * (begin_s + end_s); }
  double half_s() const { return 0.5 * (end_s - begin_s); }
  // `k`: the index in a Thrice.
  double at(int k) const { return begin_s + 0.5 * k * (end_s - begin_s); }
  double u(double dt_s) const { return is_instant() ? 0 : (dt_s - middle_s()) / half_s(); }
};

// The span of the times of all samples of a patch.
Span span_of(const View& view, const PixelBox& patch);

// The direction of a point of the frame, a unit vector in cam; NaN where the lens has none.
Vector3 ray_in_cam(const View& view, const Pixel& pixel);

// The rays of one pixel in cam: middle + x per_x + y per_y + t per_t + t^2 per_tt, in the units of
// Samples. Within a pixel a lens deviates from this by less than a thousandth of the pixel's width.
struct PixelRay {
  // True where the lens has a direction at all four corners.
  bool known = false;
  // True where the last two are not 0: the homography between frame and lens moves.
  bool moves = false;
  Eigen::Vector3f middle, per_x, per_y, per_t, per_tt;

  // The angle across the pixel.
  float pixel_rad() const { return per_x.norm(); }
};

class PixelRays {
 public:
  PixelRays(const View& view, const PixelBox& patch);
  PixelRay at(int x, int y) const;

  const Span& span() const { return span_; }
  double exposure_s() const { return view_.shutter.exposure_s; }
  // The middle of the exposure of a pixel.
  double middle_s(int x, int y) const {
    return view_.shutter.middle_s({double(x), double(y)}, view_.width, view_.height);
  }
  // True where all pixels of a row have one time.
  bool reads_rows() const {
    const Shutter& shutter = view_.shutter;
    return shutter.readout_s <= 0 || shutter.readout == Readout::kDown ||
           shutter.readout == Readout::kUp;
  }

 private:
  using Corners = std::array<Vector3, 4>;
  Corners corners(std::size_t moment, int x, int y) const;

  View view_;
  PixelBox patch_;
  Span span_;
  // At the pixels' corners, row by row, at the beginning, the middle and the end of the span where
  // the homography moves, else in the middle alone.
  Thrice<std::vector<Vector3>> directions_;
};

}  // namespace airtruth::render
