// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// The parts of a frame on which compression artefacts are simulated.
//
// A video encoder transforms the prediction error block by block, so that an intruder leaves ripple
// in every pixel of a block that it touches. Deblocking and the predictions of later frames carry a
// part of it further; the model omits that.
namespace airtruth::composite {

// Side of a block, in pixels: H.264's largest transform.
inline constexpr int kCodecBlockPx = 8;

// A part of the frame that is coded by itself: whole macroblocks of 16 x 16 pixels up to the
// frame's edge, with even sides where chroma is halved.
struct CodedWindow {
  PixelBox box{};
  // The samples before the layer is drawn.
  image::Picture background;
};

// One window around each intruder of the layer that contains all blocks within `halo_px` of it.
// Overlapping windows are merged.
std::vector<CodedWindow> coded_windows(const image::Picture& background,
                                       const image::Layer& layer,
                                       int halo_px);

// 1 for each pixel of the patch whose block contains a non-zero element of `marked`, else 0.
std::vector<std::uint8_t> in_marked_blocks(const PixelBox& patch,
                                           const std::vector<std::uint8_t>& marked);

}  // namespace airtruth::composite
