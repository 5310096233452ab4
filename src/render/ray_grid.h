// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "geometry/box.h"
#include "render/renderer.h"

namespace airtruth::render {

// Directions in world at the corners of a patch's pixels; NaN where the lens has none. Inside a
// pixel they are interpolated: over one pixel a lens is a plane to better than 1e-6 of its width.
class RayGrid {
 public:
  RayGrid(const View& view, const PixelBox& patch);

  // Of one point of the frame.
  static Vector3 direction(const View& view, const Pixel& pixel);
  // Of a pixel: at (0,0), (1,0), (0,1), (1,1).
  std::array<Vector3, 4> corners(int x, int y) const;

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(column);
  }
  PixelBox patch_;
  int width_;
  std::vector<Vector3> directions_;
};

}  // namespace airtruth::render
