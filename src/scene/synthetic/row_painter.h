// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "scene/synthetic/ground.h"
#include "scene/synthetic/own_aircraft.h"
#include "scene/synthetic/rays.h"
#include "scene/synthetic/sky.h"

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

  // Fills in directions and fall-off of the row's pixels. `nodes` are those of stride 1.
  void fill_in(int y, const std::vector<RayNode>& nodes, Row& row) const;

 private:
  // Pixels between two nodes.
  static constexpr int kPitch = 8;

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
  float focal_px = 0;
};

// A mottled disc that moves over the image independently of the camera: motion that a motion
// estimate must reject.
struct Disc {
  float x, y;
  float radius;
  std::uint32_t seed;
};

// The discs that cover a share of the image.
std::vector<Disc> clutter_at(double time_s,
                             const lens::ImageSize& size,
                             double share,
                             std::uint32_t seed);

// What changes from frame to frame.
struct Moment {
  // Rays of the table's nodes in the world.
  std::vector<RayNode> nodes;
  Eye eye;
  std::vector<Disc> discs;
};

// Draws a row of a frame.
void paint_row(const Scenery& scenery, int y, const Moment& moment, Row& row);

}  // namespace airtruth::synthetic
