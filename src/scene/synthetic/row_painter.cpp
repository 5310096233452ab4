// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/row_painter.h"

#include <algorithm>

namespace airtruth::synthetic {

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
