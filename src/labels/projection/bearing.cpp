// SPDX-License-Identifier: Apache-2.0
#include "labels/projection/bearing.h"

#include <algorithm>
#include <cmath>

namespace airtruth::projection {
namespace {

// The time of the point's own row, by fixed-point iteration; 0 where no pixel shows the point.
double row_time_s(const Sight& sight, const Vector3& p_in_world, const Vector3& velocity_mps) {
  if (sight.shutter.readout_s <= 0) return 0;
  // Each round multiplies the error by the share of the image that the point crosses during a
  // readout.
  constexpr int kRounds = 8;
  const lens::ImageSize size = sight.lens->size();
  double dt_s = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto pixel = pixel_from_world(sight.at(dt_s), p_in_world + dt_s * velocity_mps);
    if (!pixel) return 0;
    const Pixel inside(std::clamp(pixel->x(), 0.0, double(size.width)),
                       std::clamp(pixel->y(), 0.0, double(size.height)));
    dt_s = sight.shutter.middle_s(inside, size.width, size.height);
  }
  return dt_s;
}

}  // namespace

Bearing bearing_of(const Vector3& in_cam) {
  return {degrees(std::atan2(in_cam.x(), in_cam.z())),
          degrees(std::atan2(-in_cam.y(), std::hypot(in_cam.x(), in_cam.z())))};
}

Vector3 direction_of(const Bearing& bearing) {
  const double azimuth = radians(bearing.azimuth_deg);
  const double elevation = radians(bearing.elevation_deg);
  return {std::cos(elevation) * std::sin(azimuth),
          -std::sin(elevation),
          std::cos(elevation) * std::cos(azimuth)};
}

std::optional<Bearing> seen_bearing(const Sight& sight,
                                    const Vector3& p_in_world,
                                    const Vector3& velocity_in_world_mps) {
  const double dt_s = row_time_s(sight, p_in_world, velocity_in_world_mps);
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
