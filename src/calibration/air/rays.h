// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"

namespace airtruth::calibration {

// The direction in which a pixel of a lens looks.
struct PixelRay {
  int x = 0, y = 0;
  Vector3 in_cam;
};

// The rays of a grid of pixels, row by row. The grid begins at pixel `first` in both directions and
// has a spacing of `step` pixels. Pixels of the own aircraft (nullptr: there is no mask) and pixels
// outside the image circle of the lens are left out. The rays are the same for all pictures of a
// clip.
std::vector<PixelRay> pixel_rays(const lens::Lens& lens,
                                 const image::Mask* own_aircraft,
                                 int first,
                                 int step);

}  // namespace airtruth::calibration
