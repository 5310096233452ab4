// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <airtruth/labels.h>

#include "foundation/geometry/box.h"

// COCO's run lengths (Lin et al. 2014; cocodataset.org, "Data format"). Pixels are scanned down the
// columns, starting at the left, and the runs outside and inside the object are counted
// alternately. The first count is of pixels outside; it is 0 where the first pixel is inside.
namespace airtruth::pixel_mask {

// The mask of a picture of width x height pixels. `inside` is called only for the pixels of
// `bounds`, which must lie in the picture; all other pixels are outside.
exchange::PixelMask pixel_mask_of(int width,
                                  int height,
                                  const PixelBox& bounds,
                                  const std::function<bool(int x, int y)>& inside);

// The compressed text that COCO's readers accept in place of the list of counts. From the third
// count on, the count two before is subtracted. Each number is split into groups of 5 bits in two's
// complement, lowest first; 32 is added to each group that another one follows, and 48 turns it
// into a character.
std::string compressed_counts(const std::vector<std::uint32_t>& counts);

}  // namespace airtruth::pixel_mask
