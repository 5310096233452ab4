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

// The share of each pixel of a frame that one thing covers, 0..1.
struct Coverage {
  // The pixels that it may cover; width == 0: none. It covers nothing outside them.
  PixelBox box{};
  // box.height rows of box.width.
  std::vector<float> alpha;

  Coverage() = default;
  explicit Coverage(const PixelBox& of, float everywhere = 0)
      : box(of),
        alpha(static_cast<std::size_t>(of.width) * static_cast<std::size_t>(of.height),
              everywhere) {}

  bool empty() const { return alpha.empty(); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - box.y) * static_cast<std::size_t>(box.width) +
           static_cast<std::size_t>(x - box.x);
  }
  float at(int x, int y) const { return box.contains(x, y) ? alpha[index(x, y)] : 0; }
};

// Calls visit(x, y, alpha) for each pixel of the coverage's box, row by row.
template <typename Coverage, typename Visit>
void each_pixel(Coverage& coverage, const Visit& visit) {
  std::size_t i = 0;
  for (int y = coverage.box.y; y < coverage.box.bottom(); ++y)
    for (int x = coverage.box.x; x < coverage.box.right(); ++x) visit(x, y, coverage.alpha[i++]);
}

struct Layer {
  // The position in the frame; width == 0 means an empty layer.
  PixelBox patch{};
  // patch.height rows of patch.width pixels.
  std::vector<LayerPixel> pixels;
  // The alpha-weighted mean distance from the camera; +inf where alpha is 0.
  std::vector<float> depth_m;

  // By intruder, in the scene's order, after occlusion by nearer intruders, within the patch. A
  // pixel's alpha is the sum over the intruders.
  std::vector<Coverage> coverage;

  // The areas below have one entry per intruder, in pixels. They are areas of the silhouette before
  // any point spread, so that a difference between two of them is due to occlusion alone.
  //
  // Without occlusion, within the frame.
  std::vector<double> area_alone_in_frame_px;
  // Without occlusion, with the part beyond the frame's border.
  std::vector<double> area_alone_px;
  // The part of area_alone_in_frame_px that no nearer intruder hides.
  std::vector<double> area_seen_px;
  // The part of area_seen_px that the own aircraft leaves free.
  std::vector<double> area_free_px;
  // The part of area_free_px that no other occluder hides.
  std::vector<double> area_clear_px;

  // 1 for each pixel of the patch in which occluders hide every intruder wholly
  // (picture/composite/cover.h): nothing is drawn there, whatever the pixel holds. Empty: there
  // is none.
  std::vector<unsigned char> closed;

  bool is_open(std::size_t i) const { return closed.empty() || closed[i] == 0; }
  bool empty() const { return patch.width == 0; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - patch.y) * static_cast<std::size_t>(patch.width) +
           static_cast<std::size_t>(x - patch.x);
  }
};

// The own-aircraft mask, one byte per pixel: 0 where the own aircraft hides the scene, 255 where
// the view is free.
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
