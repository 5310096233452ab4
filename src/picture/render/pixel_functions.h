// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "picture/render/pixel_rays.h"
#include "picture/render/ray_triangles.h"

namespace airtruth::render {

// The three edge functions and the inverse distance of a RayTriangle over a pixel and its exposure,
// in the units of Samples:
//
//   (at + per_t t + per_tt t^2) + x (per_x + per_xt t) + y (per_y + per_yt t)
//
// The terms that no sample can tell are left out.
struct PixelFunctions {
  Eigen::Array4f at, per_x, per_y, per_t, per_xt, per_yt, per_tt;
  // The times at which they hold, which are all but for a part that turns.
  float begin_t = -2;
  float end_t = 2;

  Eigen::Array4f operator()(float x, float y, float t) const {
    return (at + per_t * t + per_tt * (t * t)) + x * (per_x + per_xt * t) +
           y * (per_y + per_yt * t);
  }
  // What no value over the pixel and the exposure deviates by from that in the middle.
  Eigen::Array4f half_range() const {
    return 0.5f * (per_x.abs() + per_y.abs()) + per_t.abs() + 0.5f * (per_xt.abs() + per_yt.abs()) +
           per_tt.abs();
  }
  bool hold_always() const { return begin_t <= -1 && end_t >= 1; }
  // True where they hold always and the motion is uniform to within a fiftieth of a pixel, so that
  // the terms of rotation and of acceleration change alpha by less than the samples leave: at an
  // edge a deviation that is uniform between -e and e adds e / 4 to the mean.
  bool is_uniform() const;
};

// `u`: the middle of the pixel's exposure in the triangle's span; `half_u`: half of the exposure.
PixelFunctions functions_over(const RayTriangle& triangle,
                              const PixelRay& ray,
                              float u,
                              float half_u);

}  // namespace airtruth::render
