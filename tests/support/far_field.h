// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "scene/synthetic/flight.h"

// For tests: how the far field of a virtual flight moves in the picture.
namespace airtruth::synthetic {

// The exact homography frame_from_first of the far field: K R_k R_0^-1 K^-1. Only for a pinhole.
inline Homography frame_from_first(const Flight& flight, int index) {
  const auto& pinhole = std::get<lens::Pinhole>(flight.lens().model());
  Matrix3 pixel_from_cam = Matrix3::Identity();
  pixel_from_cam(0, 0) = pinhole.focal_px.x();
  pixel_from_cam(1, 1) = pinhole.focal_px.y();
  pixel_from_cam(0, 2) = pinhole.principal_point_px.x();
  pixel_from_cam(1, 2) = pinhole.principal_point_px.y();
  const auto cam_from_world = [&](int k) {
    return (cam_from_body() * flight.camera(k).world_from_body.conjugate()).toRotationMatrix();
  };
  const Homography h = pixel_from_cam * cam_from_world(index) * cam_from_world(0).transpose() *
                       pixel_from_cam.inverse();
  return h / h(2, 2);
}

}  // namespace airtruth::synthetic
