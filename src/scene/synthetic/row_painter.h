// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "scene/synthetic/clutter.h"
#include "scene/synthetic/ground.h"
#include "scene/synthetic/light_row.h"
#include "scene/synthetic/own_aircraft.h"
#include "scene/synthetic/panorama.h"
#include "scene/synthetic/ray_table.h"

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
  // What the pixels of a run see: only sky and hills, the ground (or the horizon), or nothing but
  // the own aircraft.
  enum Sees : std::uint8_t { kSky, kGround, kAircraft };
  void sort_pixels(int y);
  void paint_run(std::size_t first, std::size_t end, const Eye& eye, LightRow& row);
  void soften_horizon(std::size_t first);
  void paint_own_aircraft(int y, LightRow& row) const;

  Scenery scenery_;
  RayRow directions_;
  std::vector<std::uint8_t> sees_;
  Rays rays_;
  Light light_;
};

}  // namespace airtruth::synthetic
