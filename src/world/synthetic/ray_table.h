// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "world/synthetic/noise.h"

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

  // Calls visit(x, direction) from left to right. `nodes` are those of stride 1.
  template <typename Visit>
  void for_each_in_row(int y, const std::vector<RayNode>& nodes, const Visit& visit) const {
    const int row = y / kPitch;
    const float down = (static_cast<float>(y % kPitch) + 0.5F) / kPitch;
    const RayNode* upper = nodes.data() + static_cast<std::ptrdiff_t>(row) * columns_;
    const RayNode* lower = upper + columns_;
    for (int column = 0; column + 1 < columns_; ++column) {
      const RayNode left = upper[column] + (lower[column] - upper[column]) * down;
      const RayNode right = upper[column + 1] + (lower[column + 1] - upper[column + 1]) * down;
      const RayNode step = (right - left) / kPitch;
      const int end = std::min((column + 1) * kPitch, width_);
      for (int x = column * kPitch; x < end; ++x)
        visit(x, RayNode(left + step * (static_cast<float>(x % kPitch) + 0.5F)));
    }
  }

 private:
  static constexpr int kPitch = 8;
  int width_;
  int columns_;
  int rows_;
  std::vector<RayNode> rays_in_body_;
};

}  // namespace airtruth::synthetic
