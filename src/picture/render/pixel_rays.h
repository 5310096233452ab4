// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "picture/render/ray_grid.h"
#include "picture/render/samples.h"
#include "picture/render/tracer.h"

// The rays of one pixel in an aircraft's own coordinates.
namespace airtruth::render {

// The rays at a pixel's corners at the beginning, the middle and the end of its exposure.
struct Beam {
  // True where the lens has a direction at all four corners.
  bool known = true;
  // True where the pixel is exposed for some time; only the middle moment is filled otherwise.
  bool exposes = false;
  Thrice<std::array<Vector3, 4>> direction_in_body;
  Thrice<Vector3> eye_in_body;
};
Beam beam_of(const TracedIntruder& actor, const RayGrid& grid, int x, int y);

// The ray of each sample: inside the pixel the direction is bilinear in the sample's place, and
// over its exposure a parabola in the sample's time.
class PixelRays {
 public:
  PixelRays(const TracedIntruder& actor, const RayGrid& grid, int x, int y);
  // True where the lens has a direction at all four corners of the pixel.
  bool known() const { return known_; }
  // The angle between two neighbouring corners.
  double pixel_rad() const { return pixel_rad_; }
  // Coefficients of 1, u and u^2 of the eye, with u from -1 (beginning of the exposure) to 1; only
  // the first counts at an instant.
  const Thrice<Vector3>& eye() const { return eye_; }
  // `dt_s` receives the sample's time from the frame's time; 0 at an instant.
  BodyRay ray(int sample, double& dt_s) const;

 private:
  PixelSamples samples_;
  bool known_;
  bool exposes_;
  double start_m_;
  double middle_s_ = 0;
  double exposure_s_ = 0;
  double pixel_rad_ = 0;
  // Coefficients of 1, u and u^2, with u from -1 (beginning of the exposure) to 1.
  Thrice<std::array<Vector3, 4>> direction_;
  Thrice<Vector3> eye_;
};

}  // namespace airtruth::render
