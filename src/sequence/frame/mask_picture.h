// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

namespace airtruth::sequence {

// A mask as a picture: black = own aircraft, white = free.
inline image::Rgb8 picture_of(const image::Mask& mask) {
  image::Rgb8 picture = image::make_rgb8(mask.width, mask.height);
  for (std::size_t i = 0; i < mask.free.size(); ++i)
    std::fill_n(picture.samples.get() + 3 * i,
                3,
                mask.free[i] >= 128 ? std::uint8_t{255} : std::uint8_t{0});
  return picture;
}

}  // namespace airtruth::sequence
