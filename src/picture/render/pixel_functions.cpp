// SPDX-License-Identifier: Apache-2.0
#include "picture/render/pixel_functions.h"

namespace airtruth::render {

PixelFunctions functions_over(const RayTriangle& triangle,
                              const PixelRay& ray,
                              float u,
                              float half_u) {
  PixelFunctions f;
  std::array<Eigen::Array4f, 3> now;
  for (std::size_t c = 0; c < 3; ++c)
    now[c] = triangle.of(0, c) + u * (triangle.of(1, c) + u * triangle.of(2, c));
  const auto dot = [](const Eigen::Vector3f& d, const std::array<Eigen::Array4f, 3>& n) {
    return Eigen::Array4f(d[0] * n[0] + d[1] * n[1] + d[2] * n[2]);
  };
  f.at = dot(ray.middle, now);
  f.per_x = dot(ray.per_x, now);
  f.per_y = dot(ray.per_y, now);
  f.per_t = f.per_xt = f.per_yt = f.per_tt = Eigen::Array4f::Zero();
  if (!(half_u > 0)) return f;
  std::array<Eigen::Array4f, 3> per_t;
  std::array<Eigen::Array4f, 3> per_tt;
  for (std::size_t c = 0; c < 3; ++c) {
    per_t[c] = half_u * (triangle.of(1, c) + (2 * u) * triangle.of(2, c));
    per_tt[c] = (half_u * half_u) * triangle.of(2, c);
  }
  f.per_t = dot(ray.middle, per_t);
  f.per_xt = dot(ray.per_x, per_t);
  f.per_yt = dot(ray.per_y, per_t);
  f.per_tt = dot(ray.middle, per_tt);
  if (!ray.moves) return f;
  f.per_t += dot(ray.per_t, now);
  f.per_tt += dot(ray.per_t, per_t) + dot(ray.per_tt, now);
  return f;
}

bool PixelFunctions::is_uniform() const {
  // Largest shift of an edge by the terms of rotation and acceleration that are left out.
  constexpr float kLeftOutPx = 0.02f;
  const Eigen::Array4f left_out = 0.5f * (per_xt.abs() + per_yt.abs()) + 0.5f * per_tt.abs();
  const Eigen::Array4f slope = per_x.abs().max(per_y.abs());
  return hold_always() && (left_out <= kLeftOutPx * slope).head<3>().all();
}

}  // namespace airtruth::render
