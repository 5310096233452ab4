// SPDX-License-Identifier: Apache-2.0
#include "picture/render/pixel_rays.h"

#include <algorithm>
#include <limits>

#include <tbb/parallel_for.h>

namespace airtruth::render {

View View::at(double dt_s) const {
  View moved = *this;
  moved.world_from_cam = carried(world_from_cam, camera, dt_s);
  if (!frame_from_nominal_per_s.isZero(0)) {
    const Homography frame_from_nominal = nominal_from_frame.inverse();
    moved.nominal_from_frame = (frame_from_nominal + dt_s * frame_from_nominal_per_s).inverse();
  }
  return moved;
}

Span span_of(const View& view, const PixelBox& patch) {
  const Shutter& shutter = view.shutter;
  const double half = 0.5 * std::max(0.0, shutter.exposure_s);
  const double first =
      shutter.middle_s({double(patch.x), double(patch.y)}, view.width, view.height);
  const double last = shutter.middle_s(
      {double(patch.right() - 1), double(patch.bottom() - 1)}, view.width, view.height);
  return {std::min(first, last) - half, std::max(first, last) + half};
}

Vector3 ray_in_cam(const View& view, const Pixel& pixel) {
  const Vector3 no_direction = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  const Vector3 nominal = view.nominal_from_frame * Vector3(pixel.x(), pixel.y(), 1);
  if (!(nominal.z() > 0)) return no_direction;
  const auto ray =
      view.lens->ray_from_pixel({nominal.x() / nominal.z(), nominal.y() / nominal.z()});
  return ray ? *ray : no_direction;
}

PixelRays::PixelRays(const View& view, const PixelBox& patch)
    : view_(view), patch_(patch), span_(span_of(view, patch)) {
  const bool moves = !span_.is_instant() && !view.frame_from_nominal_per_s.isZero(0);
  for (int k = moves ? 0 : 1; k < (moves ? 3 : 2); ++k) {
    const View then = view.at(span_.at(k));
    std::vector<Vector3>& directions = directions_[static_cast<std::size_t>(k)];
    directions.resize(pixels_in(patch.width + 1, patch.height + 1));
    tbb::parallel_for(0, patch.height + 1, [&](int row) {
      for (int column = 0; column <= patch.width; ++column)
        directions[index_in(patch.width + 1, column, row)] =
            ray_in_cam(then, {patch.x + column, patch.y + row});
    });
  }
}

PixelRays::Corners PixelRays::corners(std::size_t moment, int x, int y) const {
  const auto width = static_cast<std::size_t>(patch_.width + 1);
  const Vector3* first =
      &directions_[moment][index_in(patch_.width + 1, x - patch_.x, y - patch_.y)];
  return {first[0], first[1], first[width], first[width + 1]};
}

PixelRay PixelRays::at(int x, int y) const {
  PixelRay ray;
  const Corners c = corners(1, x, y);
  const Vector3 middle = (c[0] + c[1] + c[2] + c[3]) / 4;
  ray.middle = middle.cast<float>();
  ray.per_x = ((c[1] - c[0] + c[3] - c[2]) / 2).cast<float>();
  ray.per_y = ((c[2] - c[0] + c[3] - c[1]) / 2).cast<float>();
  ray.per_t = ray.per_tt = Eigen::Vector3f::Zero();
  ray.known = middle.allFinite();
  ray.moves = !directions_[0].empty();
  if (!ray.moves) return ray;
  Thrice<Vector3> of;
  for (std::size_t k = 0; k < 3; ++k) {
    const Corners then = corners(k, x, y);
    of[k] = (then[0] + then[1] + then[2] + then[3]) / 4;
    ray.known = ray.known && of[k].allFinite();
  }
  const Thrice<Vector3> by_u = parabola(of);
  const double u = span_.u(middle_s(x, y));
  const double half = 0.5 * exposure_s() / span_.half_s();
  ray.middle = (by_u[0] + u * (by_u[1] + u * by_u[2])).cast<float>();
  ray.per_t = (half * (by_u[1] + 2 * u * by_u[2])).cast<float>();
  ray.per_tt = (half * half * by_u[2]).cast<float>();
  return ray;
}

}  // namespace airtruth::render
