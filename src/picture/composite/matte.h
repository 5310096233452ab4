// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "picture/composite/sensor.h"

// Puts a layer over a frame in the frame's own samples (Porter and Duff 1984, "over", in linear
// light).
//
// Each luma sample Y under alpha > 0 becomes Y + (Y'(blend) - Y'(background)), both taken through
// the same conversion, so that the change is exactly what the layer adds and alpha = 0 changes
// nothing. A subsampled chroma sample moves by the mean of its pixels' changes, weighted by where
// the sample sits, and only where one of the pixels of its own block is under the layer. Every
// other sample keeps its bits. A sensor's sharpening, noise and soft chroma change those changes; a
// codec changes the samples that come of it (codec_blocks.h).
namespace airtruth::composite {

// What one intruder did to the frame. A pixel counts as changed when alpha > 0 there and its luma
// sample, or the chroma sample of its block, now differs from the input.
struct Visible {
  std::optional<PixelBox> covered;  // bounds of the pixels that it covers (cover.h); empty: none
  std::optional<PixelBox>
      box;                  // bounds of the changed pixels that this intruder covers; empty: none
  std::int64_t pixels = 0;  // how many
  double alpha_sum_px = 0;  // coverage that is seen: after the own aircraft and nearer intruders
  double alpha_before_mask_px = 0;  // the same before the own aircraft's mask
  std::optional<Pixel> centroid;    // of the coverage that is seen; empty: none is
};

// What a codec makes of a part of the frame, `box`: of the picture with the layer in it, and of the
// background alone. Coding both tells what the codec loses of the intruder from what it loses of
// the background a second time.
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

struct MatteOptions {
  const image::Mask* own_aircraft = nullptr;  // where not free, nothing is drawn
  // What the camera does to the samples. Sharpening and soft chroma reach beyond the layer, inside
  // its patch: spread() makes room. Each pixel's own noise makes way for as much as the light that
  // is there now would have.
  Sensor sensor;
  std::uint64_t seed = 1;  // of the noise ...
  std::int64_t frame = 0;  // ... which is another in each frame
  // Where one is given, the samples of the blocks of 8 x 8 pixels that the layer reaches become
  // what it makes of them.
  PatchCoder* coder = nullptr;
};

// One entry per intruder of the layer.
std::vector<Visible> composite_matte(image::Picture& picture,
                                     const image::Layer& layer,
                                     const MatteOptions& options);

}  // namespace airtruth::composite
