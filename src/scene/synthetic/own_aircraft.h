// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camera/lens/lens.h"
#include "foundation/image/layer.h"
#include "scene/synthetic/noise.h"
#include "scene/synthetic/sky.h"

namespace airtruth::synthetic {

// The aircraft that carries the camera, seen from its tail: wings, body and nose. It does not move
// in the image.
struct OwnAircraft {
  // Premultiplied colour and coverage by pixel; empty without an aircraft.
  std::vector<LinearRgb> layer;
  // First and last column, by row, that the aircraft covers.
  std::vector<int> first;
  std::vector<int> last;
  // 0 where the aircraft, or the area beyond the lens's field, covers any part of the pixel.
  image::Mask mask;
};

// `sun_in_body` is the direction towards the sun while the aircraft flies level.
OwnAircraft draw_own_aircraft(const lens::Lens& lens,
                              const Vector3& sun_in_body,
                              const Sky& sky,
                              bool visible);

}  // namespace airtruth::synthetic
