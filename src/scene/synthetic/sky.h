// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "foundation/geometry/transform.h"
#include "scene/synthetic/noise.h"

namespace airtruth::synthetic {

// The cloudless sky: a blue that becomes paler towards the horizon, where the path through the air
// is longer, and the sun with its glow.
class Sky {
 public:
  explicit Sky(const Vector3& sun_in_world);
  LinearRgb at(const Vector3& direction_in_world) const;
  // The colour to which distant objects fade: that of the sky just above the horizon in that
  // direction.
  LinearRgb haze(const Vector3& direction_in_world) const;
  const Vector3& sun_in_world() const { return sun_; }
  LinearRgb sunlight() const { return sunlight_; }

 private:
  Vector3 sun_;
  LinearRgb sunlight_;
};

// The unit vector towards the sun, north-east-down.
Vector3 sun_in_world(double azimuth_deg, double elevation_deg);

}  // namespace airtruth::synthetic
