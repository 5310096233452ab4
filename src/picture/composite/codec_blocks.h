// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "foundation/geometry/box.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// Which parts of a frame a codec's mark is put on.
//
// A video encoder transforms what differs from its prediction block by block, so that an intruder
// leaves ripple in every pixel of a block that it touches. Deblocking and the predictions of later
// frames carry some of it further; that is left out.
namespace airtruth::composite {

// Side of a block, in pixels: H.264's largest transform.
inline constexpr int kCodecBlockPx = 8;

// A part of the frame that is coded by itself: whole macroblocks of 16 x 16 pixels, as far as the
// frame goes, with even sides where chroma is halved.
struct CodedWindow {
  PixelBox box{};
  image::Picture background;  // its samples before the layer is drawn
};

// One window around each intruder of the layer and all blocks within `halo_px` of it. Windows that
// overlap become one.
std::vector<CodedWindow> coded_windows(const image::Picture& background,
                                       const image::Layer& layer,
                                       int halo_px);

// 1 for each pixel of the patch in whose block `marked` is not 0 somewhere.
std::vector<std::uint8_t> in_marked_blocks(const PixelBox& patch,
                                           const std::vector<std::uint8_t>& marked);

}  // namespace airtruth::composite
