// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "foundation/geometry/box.h"
#include "foundation/image/picture.h"

namespace airtruth::image {

// How much a box stands out: the root mean square difference of its luma from the median of its
// surroundings, over that of the surroundings from the same median. These are a ring as wide as the
// box's shorter side, at least kLeastRing_px, one pixel away from the box, where the point spread
// ends for the most part. Values beyond three of their differences are left out once. That is
// at least that of rounding to whole levels, 1 / sqrt(12). A box with nothing in it has about 1.
// Empty where the ring has fewer than kLeastRingPixels.
//
// Example: an aircraft of 6 x 3 px is 12 levels darker than a sky whose noise is 1.5 levels, and
// fills half of its box: sqrt(12^2 / 2) / 1.5 = 5.7.
std::optional<double> contrast_to_noise(const Picture& picture, const PixelBox& box);

// The contrast of a box's luma to its surroundings, in levels: the root mean square difference from
// the median of a ring that is as wide as the box's shorter side, at least kLeastRing_px.
double contrast(const Picture& picture, const PixelBox& box);

constexpr int kLeastRing_px = 4;
constexpr std::size_t kLeastRingPixels =
    20;  // a deviation of fewer is uncertain by a sixth or more

}  // namespace airtruth::image
