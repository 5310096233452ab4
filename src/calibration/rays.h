// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/transform.h"
#include "image/layer.h"
#include "lens/lens.h"

namespace airtruth::calibration {

// Where a pixel of a lens looks.
struct PixelRay {
  int x = 0, y = 0;
  Vector3 in_cam;
};

// Of the pixels from `first` on, `step` apart both ways, row by row, but for those that show the
// own aircraft (nullptr: none) or nothing. The same for all of a clip's pictures.
std::vector<PixelRay> pixel_rays(const lens::Lens& lens,
                                 const image::Mask* own_aircraft,
                                 int first,
                                 int step);

}  // namespace airtruth::calibration
