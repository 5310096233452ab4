// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"

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
