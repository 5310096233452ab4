// SPDX-License-Identifier: Apache-2.0
#include "world/synthetic/row_painter.h"

#include <algorithm>

namespace airtruth::synthetic {

RowPainter::RowPainter(const Scenery& scenery) : scenery_(scenery), directions_(scenery.width) {
  sky_.reserve(static_cast<std::size_t>(scenery.width));
  ground_.reserve(static_cast<std::size_t>(scenery.width));
}

void RowPainter::paint(int y, const Moment& moment, LightRow& row) {
  scenery_.view.row(y, moment.nodes, directions_, row.fall_off);
  sort_pixels(y);
  paint_sky(row);
  paint_ground(moment.eye, row);
  if (!moment.discs.empty()) Clutter::draw(moment.discs, y, scenery_.width, row);
  paint_own_aircraft(y, row);
}

// The height above the horizon in pixels, plus one half: from 0 to 1 a pixel sees both sides.
static float above_horizon(float focal_px, float down) { return focal_px * -down + 0.5F; }

void RowPainter::add_pixel(int x) {
  const bool sky =
      above_horizon(scenery_.focal_px, directions_.down[static_cast<std::size_t>(x)]) >= 1;
  (sky ? sky_ : ground_).push_back(x);
}

// Leaves out pixels that the own aircraft hides.
void RowPainter::sort_pixels(int y) {
  sky_.clear();
  ground_.clear();
  const auto row = static_cast<std::size_t>(y);
  const int width = scenery_.width;
  const int first = std::min(scenery_.own.first[row], width);
  const int last = std::max(scenery_.own.last[row], first);
  const LinearRgb* layer = scenery_.own.layer.data() + row * static_cast<std::size_t>(width);
  for (int x = 0; x < first; ++x) add_pixel(x);
  for (int x = first; x < last; ++x)
    if (layer[x][3] < 1) add_pixel(x);
  for (int x = last; x < width; ++x) add_pixel(x);
}

void RowPainter::gather(const std::vector<int>& pixels, std::size_t start) {
  rays_.count = static_cast<int>(std::min(pixels.size() - start, std::size_t{kBatch}));
  for (int i = 0; i < rays_.count; ++i) {
    const auto x = static_cast<std::size_t>(pixels[start + static_cast<std::size_t>(i)]);
    rays_.north[i] = directions_.north[x];
    rays_.east[i] = directions_.east[x];
    rays_.down[i] = directions_.down[x];
  }
}

void RowPainter::scatter(const std::vector<int>& pixels, std::size_t start, LightRow& row) const {
  for (int i = 0; i < rays_.count; ++i) {
    const auto x = static_cast<std::size_t>(pixels[start + static_cast<std::size_t>(i)]);
    row.red[x] = light_.red[i];
    row.green[x] = light_.green[i];
    row.blue[x] = light_.blue[i];
  }
}

void RowPainter::paint_sky(LightRow& row) {
  for (std::size_t start = 0; start < sky_.size(); start += kBatch) {
    gather(sky_, start);
    scenery_.panorama.seen(rays_, light_);
    scatter(sky_, start, row);
  }
}

void RowPainter::paint_ground(const Eye& eye, LightRow& row) {
  for (std::size_t start = 0; start < ground_.size(); start += kBatch) {
    gather(ground_, start);
    for (int i = 0; i < rays_.count; ++i) rays_.down[i] = std::max(rays_.down[i], 1e-5F);
    scenery_.ground.seen(eye, rays_, light_);
    soften_horizon(ground_, start);
    scatter(ground_, start, row);
  }
}

void RowPainter::soften_horizon(const std::vector<int>& pixels, std::size_t start) {
  for (int i = 0; i < rays_.count; ++i) {
    const auto x = static_cast<std::size_t>(pixels[start + static_cast<std::size_t>(i)]);
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
