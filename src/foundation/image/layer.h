// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "foundation/geometry/box.h"

namespace airtruth::image {

// A Layer holds the rendered intruders of one frame on a patch of the frame's pixel grid. `render`
// produces it, and `composite` blends it into the frame. Colour is linear light with sRGB
// primaries, premultiplied by coverage: result = colour + (1 - alpha) * background.
struct LayerPixel {
  float red = 0;
  float green = 0;
  float blue = 0;
  float alpha = 0;  // 0..1
};

struct Layer {
  PixelBox patch{};                // where in the frame; width == 0 means an empty layer
  std::vector<LayerPixel> pixels;  // patch.height rows of patch.width
  std::vector<float>
      depth_m;  // alpha-weighted mean distance from the camera; +inf where alpha is 0

  // Per intruder i (in the scene's order), coverage after occlusion by nearer intruders; alpha is
  // their sum.
  std::vector<std::vector<float>>
      coverage;  // [intruder][pixel]; an empty vector: nowhere in the patch
  // Per intruder, the sum of the coverage it would have alone, over the patch and unclipped by the
  // frame (pixels).
  std::vector<double> area_alone_in_frame_px;
  std::vector<double> area_alone_px;  // the same, with what the frame cuts off counted too
  // What is left of area_alone_in_frame_px behind nearer intruders, and of that again behind the
  // own aircraft's mask. All four areas are of the silhouette itself, before any point spread, so
  // that their differences are what hides it, and nothing else.
  std::vector<double> area_seen_px;
  std::vector<double> area_free_px;

  bool empty() const { return patch.width == 0; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - patch.y) * static_cast<std::size_t>(patch.width) +
           static_cast<std::size_t>(x - patch.x);
  }
};

// The own-aircraft mask: 1 byte a pixel, 0 = own aircraft (nothing can be seen through it), 255 =
// free.
struct Mask {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> free;  // width * height
  bool is_free(int x, int y) const {
    return free[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x)] >= 128;
  }
};

}  // namespace airtruth::image
