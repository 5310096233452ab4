// SPDX-License-Identifier: Apache-2.0
#include "picture/render/ray_grid.h"

#include <limits>

#include <tbb/parallel_for.h>

namespace airtruth::render {
namespace {

const Vector3 kNoDirection = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());

Vector3 ray_in_cam(const View& view, const Pixel& pixel) {
  const Vector3 nominal = view.nominal_from_frame * Vector3(pixel.x(), pixel.y(), 1);
  if (!(nominal.z() > 0)) return kNoDirection;
  const auto ray =
      view.lens->ray_from_pixel({nominal.x() / nominal.z(), nominal.y() / nominal.z()});
  return ray ? *ray : kNoDirection;
}

}  // namespace

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

RayGrid::RayGrid(const View& view, const PixelBox& patch)
    : view_(view), patch_(patch), span_(span_of(view, patch)), width_(patch.width + 1) {
  if (span_.is_instant()) {
    fill(view.at(span_.begin_s), 1);
    return;
  }
  // Where the homography does not change over time, the lens is called once for each pixel's ray in
  // the camera.
  const bool turns_alone = view.frame_from_nominal_per_s.isZero(0);
  if (!turns_alone) {
    for (int k = 0; k < 3; ++k) fill(view.at(span_.at(k)), k);
    return;
  }
  View in_cam = view;
  in_cam.world_from_cam.rotation = Quaternion::Identity();
  fill(in_cam, 1);
  Thrice<Matrix3> world_from_cam;
  for (int k = 0; k < 3; ++k) {
    world_from_cam[static_cast<std::size_t>(k)] =
        view.at(span_.at(k)).world_from_cam.rotation.toRotationMatrix();
    directions_[static_cast<std::size_t>(k)].resize(directions_[1].size());
  }
  for (std::size_t i = 0; i < directions_[1].size(); ++i) {
    const Vector3 ray = directions_[1][i];
    for (std::size_t k = 0; k < 3; ++k) directions_[k][i] = world_from_cam[k] * ray;
  }
}

void RayGrid::fill(const View& view, int moment) {
  auto& directions = directions_[static_cast<std::size_t>(moment)];
  directions.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(patch_.height + 1));
  tbb::parallel_for(0, patch_.height + 1, [&](int row) {
    for (int column = 0; column < width_; ++column)
      directions[index(column, row)] = direction(view, {patch_.x + column, patch_.y + row});
  });
}

Vector3 RayGrid::direction(const View& view, const Pixel& pixel) {
  return view.world_from_cam.rotation * ray_in_cam(view, pixel);
}

std::array<Vector3, 4> RayGrid::corners(int x, int y, int moment) const {
  const auto& directions = directions_[span_.is_instant() ? 1 : static_cast<std::size_t>(moment)];
  const int c = x - patch_.x;
  const int r = y - patch_.y;
  return {directions[index(c, r)],
          directions[index(c + 1, r)],
          directions[index(c, r + 1)],
          directions[index(c + 1, r + 1)]};
}

}  // namespace airtruth::render
