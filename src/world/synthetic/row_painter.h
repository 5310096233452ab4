// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "world/synthetic/clutter.h"
#include "world/synthetic/ground.h"
#include "world/synthetic/light_row.h"
#include "world/synthetic/own_aircraft.h"
#include "world/synthetic/panorama.h"
#include "world/synthetic/ray_table.h"

namespace airtruth::synthetic {

// What a frame shows: the world, and what hides it.
struct Scenery {
  const RayTable& view;
  const Panorama& panorama;
  const Ground& ground;
  const OwnAircraft& own;
  int width = 0;
  float focal_px = 0;
};

// What changes from frame to frame.
struct Moment {
  // Rays of the table's nodes in the world.
  std::vector<RayNode> nodes;
  Eye eye;
  std::vector<Clutter::Disc> discs;
};

// Draws the rows of a frame from top to bottom. Each thread has its own painter.
class RowPainter {
 public:
  explicit RowPainter(const Scenery& scenery);
  void paint(int y, const Moment& moment, LightRow& row);

 private:
  void sort_pixels(int y);
  void add_pixel(int x);
  void paint_sky(LightRow& row);
  void paint_ground(const Eye& eye, LightRow& row);
  void paint_own_aircraft(int y, LightRow& row) const;
  void gather(const std::vector<int>& pixels, std::size_t start);
  void scatter(const std::vector<int>& pixels, std::size_t start, LightRow& row) const;
  void soften_horizon(const std::vector<int>& pixels, std::size_t start);

  Scenery scenery_;
  RayRow directions_;
  // Pixels that see the sky or hills alone, and pixels that see the ground.
  std::vector<int> sky_;
  std::vector<int> ground_;
  Rays rays_;
  Light light_;
};

}  // namespace airtruth::synthetic
