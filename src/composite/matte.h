// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "composite/sensor.h"
#include "geometry/box.h"
#include "image/layer.h"
#include "image/picture.h"

// Puts a layer over a frame in the frame's own samples (Porter and Duff 1984, "over", in linear
// light).
//
// Each luma sample Y under alpha > 0 becomes Y + (Y'(blend) - Y'(background)), both taken through
// the same conversion, so that the change is exactly what the layer adds and alpha = 0 changes
// nothing. A subsampled chroma sample moves by the mean of its pixels' changes, weighted by where
// the sample sits, and only where one of the pixels of its own block is under the layer. Every
// other sample keeps its bits. A sensor's sharpening, noise and quantiser change those changes.
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

struct MatteOptions {
  const image::Mask* own_aircraft = nullptr;  // where not free, nothing is drawn
  // What the camera does to the samples. Sharpening puts a halo around the layer, inside its patch:
  // spread() makes room. Each pixel's own noise makes way for as much as the light that is there
  // now would have; the codec keeps what it would keep.
  Sensor sensor;
  std::uint64_t seed = 1;  // of the noise ...
  std::int64_t frame = 0;  // ... which is another in each frame
};

// One entry per intruder of the layer.
std::vector<Visible> composite_matte(image::Picture& picture,
                                     const image::Layer& layer,
                                     const MatteOptions& options);

}  // namespace airtruth::composite
