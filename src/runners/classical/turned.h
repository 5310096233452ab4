// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "runners/detector/detector.h"

namespace airtruth::classical {

// Where a camera that was turned otherwise sees what this one sees at a pixel; empty where it does
// not. Exact for a far point through any lens.
inline std::optional<Pixel> pixel_after_turn(const lens::Lens& lens,
                                             const Quaternion& other_from_this,
                                             const Pixel& pixel) {
  const auto ray = lens.ray_from_pixel(pixel);
  return ray ? lens.pixel_from_cam(other_from_this * *ray) : std::nullopt;
}

}  // namespace airtruth::classical
