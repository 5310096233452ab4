// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "foundation/geometry/transform.h"
#include "labels/projection/exact_box.h"

namespace airtruth::projection {

// A direction in the camera's axes, in degrees: azimuth = atan2(x, z), right positive; elevation =
// atan2(-y, hypot(x, z)), up positive. The optical axis has the bearing (0, 0).
struct Bearing {
  double azimuth_deg = 0;
  double elevation_deg = 0;
};

Bearing bearing_of(const Vector3& in_cam);

// The bearing of a point in the camera as it was when it exposed that point: the ray, through the
// lens alone, of the pixel where the point is drawn. Where motion is a rotation, the bearing
// includes the measured rotation. Where motion is a homography, which moves the picture, the
// bearing is the ray of the pixel to which the homography moves the point. With a rolling shutter
// the time is that of the point's own row. Under a homography the result is empty for a point that
// no pixel shows (behind the camera, beyond the lens's field).
std::optional<Bearing> seen_bearing(const Sight& sight,
                                    const Vector3& p_in_world,
                                    const Vector3& velocity_in_world_mps);

}  // namespace airtruth::projection
