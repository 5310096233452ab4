// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "scene/synthetic/light_row.h"

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
  static constexpr int kPitch = 8;
  static void fill(float left, float step, float* pixels);

  int columns_;
  int rows_;
  std::vector<RayNode> rays_in_body_;
};

}  // namespace airtruth::synthetic
