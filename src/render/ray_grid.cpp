// SPDX-License-Identifier: Apache-2.0
#include "render/ray_grid.h"

#include <limits>

#include <tbb/parallel_for.h>

namespace airtruth::render {

RayGrid::RayGrid(const View& view, const PixelBox& patch) : patch_(patch), width_(patch.width + 1) {
  directions_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(patch.height + 1));
  tbb::parallel_for(0, patch.height + 1, [&](int row) {
    for (int column = 0; column < width_; ++column)
      directions_[index(column, row)] = direction(view, {patch.x + column, patch.y + row});
  });
}

Vector3 RayGrid::direction(const View& view, const Pixel& pixel) {
  const Vector3 nominal = view.nominal_from_frame * Vector3(pixel.x(), pixel.y(), 1);
  const Vector3 nowhere = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  if (!(nominal.z() > 0)) return nowhere;
  const auto ray =
      view.lens->ray_from_pixel({nominal.x() / nominal.z(), nominal.y() / nominal.z()});
  return ray ? Vector3(view.world_from_cam.rotation * *ray) : nowhere;
}

std::array<Vector3, 4> RayGrid::corners(int x, int y) const {
  const int c = x - patch_.x;
  const int r = y - patch_.y;
  return {directions_[index(c, r)],
          directions_[index(c + 1, r)],
          directions_[index(c, r + 1)],
          directions_[index(c + 1, r + 1)]};
}

}  // namespace airtruth::render
