// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/row_painter.h"

#include <algorithm>

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

namespace {

// The height above the horizon in pixels, plus one half: from 0 to 1 a pixel sees both sides.
inline float above_horizon(float focal_px, float down) { return focal_px * -down + 0.5F; }

AIRTRUTH_FOR_VECTORS
void find_ground(const float* down,
                 float focal_px,
                 std::size_t width,
                 std::uint8_t* __restrict sees_ground) {
  for (std::size_t x = 0; x < width; ++x)
    sees_ground[x] = above_horizon(focal_px, down[x]) >= 1 ? 0 : 1;
}

}  // namespace

RowPainter::RowPainter(const Scenery& scenery)
    : scenery_(scenery),
      directions_(scenery.width),
      sees_(static_cast<std::size_t>(scenery.width)) {}

void RowPainter::paint(int y, const Moment& moment, LightRow& row) {
  scenery_.view.row(y, moment.nodes, directions_, row.fall_off);
  sort_pixels(y);
  for (std::size_t first = 0; first < sees_.size();) {
    std::size_t end = first + 1;
    while (end < sees_.size() && end - first < kBatch && sees_[end] == sees_[first]) ++end;
    paint_run(first, end, moment.eye, row);
    first = end;
  }
  if (!moment.discs.empty()) Clutter::draw(moment.discs, y, scenery_.width, row);
  paint_own_aircraft(y, row);
}

void RowPainter::sort_pixels(int y) {
  find_ground(directions_.down.data(), scenery_.focal_px, sees_.size(), sees_.data());
  const auto line = static_cast<std::size_t>(y);
  const LinearRgb* layer = scenery_.own.layer.data() + line * sees_.size();
  for (int x = scenery_.own.first[line]; x < scenery_.own.last[line]; ++x)
    if (layer[x][3] >= 1) sees_[static_cast<std::size_t>(x)] = kAircraft;
}

void RowPainter::paint_run(std::size_t first, std::size_t end, const Eye& eye, LightRow& row) {
  const std::uint8_t sees = sees_[first];
  if (sees == kAircraft) return;
  const std::size_t count = end - first;
  rays_.count = static_cast<int>(count);
  std::copy_n(&directions_.north[first], count, rays_.north);
  std::copy_n(&directions_.east[first], count, rays_.east);
  std::copy_n(&directions_.down[first], count, rays_.down);
  if (sees == kSky) {
    scenery_.panorama.seen(rays_, light_);
  } else {
    for (int i = 0; i < rays_.count; ++i) rays_.down[i] = std::max(rays_.down[i], 1e-5F);
    scenery_.ground.seen(eye, rays_, light_);
    soften_horizon(first);
  }
  std::copy_n(light_.red, count, &row.red[first]);
  std::copy_n(light_.green, count, &row.green[first]);
  std::copy_n(light_.blue, count, &row.blue[first]);
}

// Blends ground and sky in the pixels that the horizon crosses.
void RowPainter::soften_horizon(std::size_t first) {
  for (int i = 0; i < rays_.count; ++i) {
    const std::size_t x = first + static_cast<std::size_t>(i);
    const float down = directions_.down[x];
    const float sky_share = above_horizon(scenery_.focal_px, down);
    if (sky_share <= 0) continue;
    const LinearRgb sky = scenery_.panorama.at(directions_.north[x], directions_.east[x], -down);
    light_.red[i] += (sky[0] - light_.red[i]) * sky_share;
    light_.green[i] += (sky[1] - light_.green[i]) * sky_share;
    light_.blue[i] += (sky[2] - light_.blue[i]) * sky_share;
  }
}

void RowPainter::paint_own_aircraft(int y, LightRow& row) const {
  const OwnAircraft& own = scenery_.own;
  const auto line = static_cast<std::size_t>(y);
  const LinearRgb* layer = own.layer.data() + line * static_cast<std::size_t>(scenery_.width);
  for (int x = own.first[line]; x < own.last[line]; ++x) {
    const LinearRgb& over = layer[x];
    const auto i = static_cast<std::size_t>(x);
    row.red[i] = row.red[i] * (1 - over[3]) + over[0];
    row.green[i] = row.green[i] * (1 - over[3]) + over[1];
    row.blue[i] = row.blue[i] * (1 - over[3]) + over[2];
  }
}

}  // namespace airtruth::synthetic
