// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// A picture resampled to elevation over azimuth about a guessed horizon, where planes near the
// guess are sines.
namespace airtruth::motion {

// The planes near the guess among which a horizon is sought.
struct Sweep {
  double low_deg, high_deg;  // the range of elevations above the guess
  double step_deg;
  double across_deg;     // the height of the band on either side of the line that is averaged
  double most_tilt_deg;  // the largest tilt of a plane against the guess
};

// The step of luma from below to above, by azimuth and elevation, and the step that the slope of
// the sky above makes over the same angle. The latter is 0 where that sky is outside the picture.
struct Unrolled {
  std::vector<double> azimuth_rad;
  std::vector<float> step, sky;  // [column][row]
  int rows = 0;
  std::size_t at(std::size_t column, int row) const {
    return column * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
};

// Resamples a picture. The axes of level are x ahead along the optical axis, y right and z down.
// Azimuths at which nothing is seen are left out.
Unrolled unroll(const image::Picture& picture,
                const lens::Lens& lens,
                const image::Mask* own_aircraft,
                const Quaternion& cam_from_level,
                const Sweep& sweep);

}  // namespace airtruth::motion
