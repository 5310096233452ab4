// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/ray_table.h"

namespace airtruth::synthetic {
namespace {

// Beyond the lens's field: the last valid ray on the way there. Such pixels are black in the end.
Vector3 ray_or_nearest(const lens::Lens& lens, const Pixel& pixel) {
  if (const auto ray = lens.ray_from_pixel(pixel)) return *ray;
  const Pixel middle(0.5 * lens.size().width, 0.5 * lens.size().height);
  double inside = 0;
  double outside = 1;
  for (int i = 0; i < 30; ++i) {
    const double t = 0.5 * (inside + outside);
    (lens.ray_from_pixel(middle + t * (pixel - middle)) ? inside : outside) = t;
  }
  const auto ray = lens.ray_from_pixel(middle + inside * (pixel - middle));
  return ray ? *ray : Vector3(0, 0, 1);
}

}  // namespace

RayTable::RayTable(const lens::Lens& lens, bool falls_off)
    : columns_((lens.size().width + kPitch - 1) / kPitch + 1),
      rows_((lens.size().height + kPitch - 1) / kPitch + 1) {
  const Quaternion body_from_cam = cam_from_body().conjugate();
  const Pixel middle(0.5 * lens.size().width, 0.5 * lens.size().height);
  rays_in_body_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const Pixel pixel(column * kPitch, row * kPitch);
      const Vector3 ray = body_from_cam * ray_or_nearest(lens, pixel);
      const double off_centre = (pixel - middle).squaredNorm() / middle.squaredNorm();
      RayNode node;
      node.head<3>() = ray.cast<float>().array();
      node[3] = falls_off
                    ? static_cast<float>(1 - 0.26 * off_centre - 0.08 * off_centre * off_centre)
                    : 1.0F;
      rays_in_body_.push_back(node);
    }
}

std::vector<RayNode> RayTable::directions_in_world(const Quaternion& world_from_body,
                                                   int stride) const {
  const Eigen::Matrix3f turn = world_from_body.toRotationMatrix().cast<float>();
  std::vector<RayNode> nodes;
  nodes.reserve(rays_in_body_.size() / static_cast<std::size_t>(stride * stride) + 1);
  for (int row = 0; row < rows_; row += stride)
    for (int column = 0; column < columns_; column += stride) {
      const RayNode& ray = rays_in_body_[static_cast<std::size_t>(row * columns_ + column)];
      RayNode node = ray;
      node.head<3>() = (turn * ray.head<3>().matrix()).array();
      nodes.push_back(node);
    }
  return nodes;
}

// Interpolates the pixels between two nodes.
void RayTable::fill(float left, float step, float* pixels) {
  for (int x = 0; x < kPitch; ++x) pixels[x] = left + step * (static_cast<float>(x) + 0.5F);
}

void RayTable::row(int y,
                   const std::vector<RayNode>& nodes,
                   RayRow& directions,
                   std::vector<float>& fall_off) const {
  const float below = (static_cast<float>(y % kPitch) + 0.5F) / kPitch;
  const RayNode* upper = nodes.data() + static_cast<std::ptrdiff_t>(y / kPitch) * columns_;
  const RayNode* lower = upper + columns_;
  RayNode left = upper[0] + (lower[0] - upper[0]) * below;
  for (int column = 0; column + 1 < columns_; ++column) {
    const RayNode right = upper[column + 1] + (lower[column + 1] - upper[column + 1]) * below;
    const RayNode step = (right - left) / kPitch;
    const std::size_t first = static_cast<std::size_t>(column) * kPitch;
    fill(left[0], step[0], &directions.north[first]);
    fill(left[1], step[1], &directions.east[first]);
    fill(left[2], step[2], &directions.down[first]);
    fill(left[3], step[3], &fall_off[first]);
    left = right;
  }
}

}  // namespace airtruth::synthetic
