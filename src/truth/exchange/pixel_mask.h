// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "foundation/geometry/box.h"
#include "truth/exchange/labels.h"

// COCO's run lengths (Lin et al. 2014; cocodataset.org, "Data format"): counts of pixels, down the
// columns from the left, of those outside and those inside by turns, outside first (0 where the
// first pixel is inside).
namespace airtruth::exchange {

// The mask of a picture of width x height pixels. `inside` is asked for the pixels of `bounds`
// alone, which lie in the picture; all others are outside.
PixelMask pixel_mask_of(int width,
                        int height,
                        const PixelBox& bounds,
                        const std::function<bool(int x, int y)>& inside);

// The text that COCO's readers take in place of the list of counts. From the third on each count is
// less by the one two before it; each number goes into groups of 5 bits, lowest first, in two's
// complement, 32 is added to each group that another follows, and 48 makes it a character.
std::string compressed_counts(const std::vector<std::uint32_t>& counts);

}  // namespace airtruth::exchange
