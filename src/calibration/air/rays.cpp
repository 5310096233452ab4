// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/rays.h"

namespace airtruth::calibration {

std::vector<PixelRay> pixel_rays(const lens::Lens& lens,
                                 const image::Mask* own_aircraft,
                                 int first,
                                 int step) {
  std::vector<PixelRay> rays;
  for (int y = first; y < lens.size().height; y += step)
    for (int x = first; x < lens.size().width; x += step) {
      if (own_aircraft != nullptr && !own_aircraft->is_free(x, y)) continue;
      if (const auto ray = lens.ray_from_pixel({x + 0.5, y + 0.5})) rays.push_back({x, y, *ray});
    }
  return rays;
}

}  // namespace airtruth::calibration
