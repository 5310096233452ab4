// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "scene/synthetic/clutter.h"
#include "scene/synthetic/ground.h"
#include "scene/synthetic/own_aircraft.h"
#include "scene/synthetic/panorama.h"
#include "scene/synthetic/rays.h"

namespace airtruth::synthetic {

// Unit direction of a ray (x, y, z) and the fall-off of the light of the lens, 0 to 1.
using RayNode = Eigen::Array4f;

// The lens as a table: rays at nodes every few pixels, with linear interpolation between them
// (within 0.02 px for a lens of 75 degrees). The fourth number of a node is the lens's fall-off of
// light.
class RayTable {
 public:
  // falls_off: true where less light reaches the corners than the middle, as through a cheap lens.
  RayTable(const lens::Lens& lens, bool falls_off);

  // Rays of every `stride`-th node, rotated into the world.
  std::vector<RayNode> directions_in_world(const Quaternion& world_from_body, int stride) const;

  // Directions and fall-off of the row's pixels. `nodes` are those of stride 1.
  void row(int y,
           const std::vector<RayNode>& nodes,
           RayRow& directions,
           std::vector<float>& fall_off) const;

 private:
  // Pixels between two nodes.
  static constexpr int kPitch = 8;
  static void fill(float left, float step, float* pixels);

  int columns_;
  int rows_;
  std::vector<RayNode> rays_in_body_;
};

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
