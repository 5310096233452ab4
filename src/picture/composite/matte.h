// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "picture/composite/cover.h"
#include "picture/composite/sensor.h"

// Composites a layer over a frame in the frame's own samples (Porter and Duff 1984, "over", in
// linear light).
//
// Each luma sample Y under alpha > 0 becomes Y + (Y'(blend) - Y'(background)). Both terms go
// through the same conversion, so that the change is exactly what the layer adds and alpha = 0
// changes nothing. A subsampled chroma sample changes by the mean of its pixels' changes, weighted
// by the sample's position, and only where a pixel of its own block is under the layer. Every other
// sample keeps its bits. The sensor's sharpening, noise and chroma blur act on these changes; a
// codec acts on the resulting samples (codec_blocks.h).
//
// Example: a full-range grey sample of 128 under a black layer with an alpha of 0.5 and sRGB's
// curve. Its linear light of 0.2159 becomes 0.1079, which is coded as 92. A blend of the coded
// values would give 64.
namespace airtruth::composite {

// The effect of one intruder on the frame. A pixel counts as changed where alpha > 0 and its luma
// sample, or the chroma sample of its block, differs from the input.
struct Visible {
  // The pixels that it covers; empty: none.
  std::optional<Covered> covered;
  // Bounds of the changed pixels that this intruder covers; empty: none.
  std::optional<PixelBox> box;
  // The number of those changed pixels.
  std::int64_t pixels = 0;
  // Adds a changed pixel.
  void add(int x, int y) {
    const PixelBox pixel{x, y, 1, 1};
    box = box ? bounds(*box, pixel) : pixel;
    ++pixels;
  }
  // Sum of the visible coverage, in pixels: after occluders and nearer intruders.
  double alpha_sum_px = 0;
  // Centroid of the visible coverage; empty where there is none.
  std::optional<Pixel> centroid;
};

// Adds what the layer covers: all of `visible` but its changed pixels.
void add_coverage(const image::Layer& layer, std::size_t intruder, Visible& visible);

// The result of a codec on a part of the frame, `box`: for the picture with the layer, and for the
// background alone. The difference separates the codec's loss on the intruder from its second loss
// on the background.
struct Coded {
  image::Picture with_layer;
  image::Picture background;
};
class PatchCoder {
 public:
  virtual ~PatchCoder() = default;
  virtual Coded code(const PixelBox& box,
                     const image::Picture& with_layer,
                     const image::Picture& background) = 0;
};

// Options of the matte.
struct MatteOptions {
  // The camera's effect on the samples. Sharpening and chroma blur reach beyond the layer but stay
  // inside its patch: spread() enlarges the patch for them. Each pixel's own noise is scaled to the
  // level of the light that is there after the blend.
  Sensor sensor;
  // Seed of the noise.
  std::uint64_t seed = 1;
  // Number of the frame; each frame has different noise.
  std::int64_t frame = 0;
  // Where a coder is given, it replaces the samples of the blocks of 8 x 8 pixels that the layer
  // reaches.
  PatchCoder* coder = nullptr;
};

// Returns one entry for each intruder of the layer.
std::vector<Visible> composite_matte(image::Picture& picture,
                                     const image::Layer& layer,
                                     const MatteOptions& options);

}  // namespace airtruth::composite
