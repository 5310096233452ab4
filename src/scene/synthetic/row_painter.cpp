// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/row_painter.h"

#include <algorithm>
#include <array>
#include <cmath>

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

void RayTable::fill_in(int y, const std::vector<RayNode>& nodes, Row& row) const {
  const float below = (static_cast<float>(y % kPitch) + 0.5F) / kPitch;
  const RayNode* upper = nodes.data() + static_cast<std::ptrdiff_t>(y / kPitch) * columns_;
  const RayNode* lower = upper + columns_;
  RayNode left = upper[0] + (lower[0] - upper[0]) * below;
  for (int column = 0; column + 1 < columns_; ++column) {
    const RayNode right = upper[column + 1] + (lower[column + 1] - upper[column + 1]) * below;
    const RayNode step = (right - left) / kPitch;
    const std::array parts{&row.north, &row.east, &row.down, &row.fall_off};
    for (std::size_t part = 0; part < parts.size(); ++part)
      for (int x = 0; x < kPitch; ++x)
        (*parts[part])[static_cast<std::size_t>(column * kPitch + x)] =
            left[part] + step[part] * (static_cast<float>(x) + 0.5F);
    left = right;
  }
}

namespace {

// The height above the horizon in pixels, plus one half: from 0 to 1 a pixel sees both sides.
inline float above_horizon(float focal_px, float down) { return focal_px * -down + 0.5F; }

// A triangle wave between 0 and 1.
float bounce(double x) {
  const double turn = x - 2 * std::floor(x / 2);
  return static_cast<float>(turn < 1 ? turn : 2 - turn);
}

void draw(const Disc& disc, int y, int width, Row& row) {
  const float dy = static_cast<float>(y) + 0.5F - disc.y;
  if (std::abs(dy) >= disc.radius) return;
  const float reach = std::sqrt(disc.radius * disc.radius - dy * dy);
  const int first = std::max(static_cast<int>(disc.x - reach), 0);
  const int last = std::min(static_cast<int>(disc.x + reach) + 1, width);
  for (int x = first; x < last; ++x) {
    const float dx = static_cast<float>(x) + 0.5F - disc.x;
    const float edge = 1 - std::sqrt(dx * dx + dy * dy) / disc.radius;
    if (edge <= 0) continue;
    const float scale = 4.5F / disc.radius;
    const float mottle = fractal(dx * scale + 64, dy * scale + 64, 2, 128, disc.seed);
    const LinearRgb tone = linear_rgb(0.75F, 0.72F, 0.66F) * (mottle * mottle * 1.5F);
    const float covered = smoothstep(0.0F, 0.25F, edge);
    const auto i = static_cast<std::size_t>(x);
    row.red[i] += (tone[0] - row.red[i]) * covered;
    row.green[i] += (tone[1] - row.green[i]) * covered;
    row.blue[i] += (tone[2] - row.blue[i]) * covered;
  }
}

// What a pixel sees: only sky and hills, the ground (or the horizon), or nothing but the own
// aircraft.
enum Sees : std::uint8_t { kSky, kGround, kAircraft };

std::vector<Sees> seen_by_pixels(const Scenery& scenery, int y, const Row& row) {
  std::vector<Sees> sees(static_cast<std::size_t>(scenery.own.mask.width));
  for (std::size_t x = 0; x < sees.size(); ++x)
    sees[x] = above_horizon(scenery.focal_px, row.down[x]) >= 1 ? kSky : kGround;
  const auto line = static_cast<std::size_t>(y);
  const LinearRgb* layer = scenery.own.layer.data() + line * sees.size();
  for (int x = scenery.own.first[line]; x < scenery.own.last[line]; ++x)
    if (layer[x][3] >= 1) sees[static_cast<std::size_t>(x)] = kAircraft;
  return sees;
}

// Ground and sky are blended in the pixels that the horizon crosses.
void paint_run(const Scenery& scenery, Sees sees, const Row::Run& pixels, const Eye& eye) {
  if (sees == kAircraft) return;
  if (sees == kGround) scenery.ground.light(eye, pixels);
  for (int i = 0; i < pixels.count; ++i) {
    const float sky_share = above_horizon(scenery.focal_px, pixels.down[i]);
    if (sky_share <= 0) continue;
    const LinearRgb sky = scenery.panorama.at(pixels.north[i], pixels.east[i], -pixels.down[i]);
    const LinearRgb ground = linear_rgb(pixels.red[i], pixels.green[i], pixels.blue[i]);
    const LinearRgb light = sees == kSky ? sky : LinearRgb(ground + (sky - ground) * sky_share);
    pixels.red[i] = light[0];
    pixels.green[i] = light[1];
    pixels.blue[i] = light[2];
  }
}

void add_own_aircraft(const Scenery& scenery, int y, Row& row) {
  const OwnAircraft& own = scenery.own;
  const auto line = static_cast<std::size_t>(y);
  const LinearRgb* layer =
      own.layer.data() + line * static_cast<std::size_t>(scenery.own.mask.width);
  for (int x = own.first[line]; x < own.last[line]; ++x) {
    const LinearRgb& over = layer[x];
    const auto i = static_cast<std::size_t>(x);
    row.red[i] = row.red[i] * (1 - over[3]) + over[0];
    row.green[i] = row.green[i] * (1 - over[3]) + over[1];
    row.blue[i] = row.blue[i] * (1 - over[3]) + over[2];
  }
}

}  // namespace

std::vector<Disc> clutter_at(double time_s,
                             const lens::ImageSize& size,
                             double share,
                             std::uint32_t seed) {
  std::vector<Disc> discs;
  if (share <= 0) return discs;
  const float radius = 0.032F * static_cast<float>(size.height);
  const double area = 3.14159 * radius * radius;
  const int count =
      std::max(1, static_cast<int>(std::lround(share * size.width * size.height / area)));
  for (int i = 0; i < count; ++i) {
    const std::uint32_t id = hash(i, 0, seed);
    const auto draw = [&](std::uint32_t k) { return unit(mix(id + k)); };
    // One crossing of the image takes 8 to 40 s.
    const double across = time_s * (0.025 + 0.1 * draw(1)) + 2 * draw(2);
    const double along = time_s * (0.025 + 0.1 * draw(3)) + 2 * draw(4);
    discs.push_back({bounce(across) * static_cast<float>(size.width),
                     bounce(along) * static_cast<float>(size.height),
                     radius * (0.7F + 0.6F * draw(5)),
                     id});
  }
  return discs;
}

void paint_row(const Scenery& scenery, int y, const Moment& moment, Row& row) {
  scenery.view.fill_in(y, moment.nodes, row);
  const std::vector<Sees> sees = seen_by_pixels(scenery, y, row);
  for (std::size_t first = 0; first < sees.size();) {
    std::size_t end = first + 1;
    while (end < sees.size() && end - first < Row::kRun && sees[end] == sees[first]) ++end;
    paint_run(scenery, sees[first], row.run(first, end - first), moment.eye);
    first = end;
  }
  for (const Disc& disc : moment.discs) draw(disc, y, scenery.own.mask.width, row);
  add_own_aircraft(scenery, y, row);
}

}  // namespace airtruth::synthetic
