// SPDX-License-Identifier: Apache-2.0
#include "labels/projection/bearing.h"

#include <cmath>

namespace airtruth::projection {
Bearing bearing_of(const Vector3& in_cam) {
  return {degrees(std::atan2(in_cam.x(), in_cam.z())),
          degrees(std::atan2(-in_cam.y(), std::hypot(in_cam.x(), in_cam.z())))};
}

std::optional<Bearing> seen_bearing(const Sight& sight,
                                    const Vector3& p_in_world,
                                    const Vector3& velocity_in_world_mps) {
  constexpr int kRounds = 8;
  const auto pixel_at = [&](double dt_s) {
    return pixel_from_world(sight.at(dt_s), p_in_world + dt_s * velocity_in_world_mps);
  };
  const lens::ImageSize size = sight.lens->size();
  const double dt_s = sight.shutter.seen_s(pixel_at, size.width, size.height, kRounds);
  const Sight then = dt_s == 0 ? sight : sight.at(dt_s);
  const Vector3 p_then = p_in_world + dt_s * velocity_in_world_mps;
  if (then.frame_from_nominal == Homography::Identity())
    return bearing_of(then.cam_from_world * p_then);
  const auto pixel = pixel_from_world(then, p_then);
  if (!pixel) return std::nullopt;
  const auto ray = sight.lens->ray_from_pixel(*pixel);
  return ray ? std::optional(bearing_of(*ray)) : std::nullopt;
}

}  // namespace airtruth::projection
