// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "world/synthetic/noise.h"
#include "world/synthetic/sky.h"

namespace airtruth::synthetic {

// The aircraft that carries the camera, seen from its tail: wings, body and nose. It does not move
// in the image.
struct OwnAircraft {
  std::vector<Light> layer;  // premultiplied colour and coverage, by pixel; empty without aircraft
  std::vector<int> first;    // by row, the part that it covers
  std::vector<int> last;
  image::Mask mask;  // 0 where it, or what the lens cannot see, covers any part of the pixel
};

// `sun_in_body` is the sun's direction as the aircraft flies level.
OwnAircraft draw_own_aircraft(const lens::Lens& lens,
                              const Vector3& sun_in_body,
                              const Sky& sky,
                              bool visible);

}  // namespace airtruth::synthetic
