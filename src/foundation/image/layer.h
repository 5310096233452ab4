// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
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
      : box(of), alpha(pixels_in(of), everywhere) {}

  bool empty() const { return alpha.empty(); }
  std::size_t index(int x, int y) const { return index_in(box, x, y); }
  float at(int x, int y) const { return box.contains(x, y) ? alpha[index(x, y)] : 0; }
};

// Calls visit(x, y, alpha) for each pixel of the coverage's box, row by row.
template <typename Coverage, typename Visit>
void each_pixel(Coverage& coverage, const Visit& visit) {
  std::size_t i = 0;
  for (int y = coverage.box.y; y < coverage.box.bottom(); ++y)
    for (int x = coverage.box.x; x < coverage.box.right(); ++x) visit(x, y, coverage.alpha[i++]);
}

// Areas of an intruder's silhouette before any point spread, in pixels, so that a difference
// between two of them is due to occlusion alone.
struct Areas {
  double alone_px = 0;           // without occlusion, with the part beyond the frame's border
  double alone_in_frame_px = 0;  // without occlusion, within the frame
  double seen_px = 0;            // the part of alone_in_frame_px that no nearer intruder hides
  double free_px = 0;            // the part of seen_px that the own aircraft leaves free
  double clear_px = 0;           // the part of free_px that no other occluder hides
  bool operator==(const Areas&) const = default;
};

struct Layer {
  Layer() = default;
  // Nothing on a patch.
  explicit Layer(const PixelBox& on)
      : patch(on),
        pixels(pixels_in(on)),
        depth_m(pixels.size(), std::numeric_limits<float>::infinity()) {}

  // The position in the frame; width == 0 means an empty layer.
  PixelBox patch{};
  // patch.height rows of patch.width pixels.
  std::vector<LayerPixel> pixels;
  // The alpha-weighted mean distance from the camera; +inf where alpha is 0.
  std::vector<float> depth_m;

  // By intruder, in the scene's order, after occlusion by nearer intruders, within the patch. A
  // pixel's alpha is the sum over the intruders.
  std::vector<Coverage> coverage;

  // By intruder.
  std::vector<Areas> areas;

  // 1 for each pixel of the patch in which occluders hide every intruder wholly
  // (picture/composite/cover.h): nothing is drawn there, whatever the pixel holds. Empty: there
  // is none.
  std::vector<unsigned char> closed;

  bool is_open(std::size_t i) const { return closed.empty() || closed[i] == 0; }
  bool empty() const { return patch.width == 0; }
  std::size_t index(int x, int y) const { return index_in(patch, x, y); }
};

// The own-aircraft mask, one byte per pixel: 0 where the own aircraft hides the scene, 255 where
// the view is free.
struct Mask {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> free;  // width * height
  bool is_free(int x, int y) const { return free[index_in(width, x, y)] >= 128; }
};

}  // namespace airtruth::image
