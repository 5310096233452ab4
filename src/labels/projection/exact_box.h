// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "aircraft/model/mesh.h"
#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/within_frame.h"

namespace airtruth::projection {

// The projection of the world into one frame: the ray of docs/architecture.md in reverse, from
// world to pixel.
struct Sight {
  const lens::Lens* lens = nullptr;
  // At the frame's time, as are all fields without a time of their own.
  Rigid cam_from_world;
  Homography frame_from_nominal = Homography::Identity();
  // Motion within the frame.
  Shutter shutter;
  // The motion of world_from_cam.
  Twist camera;
  Homography frame_from_nominal_per_s = Homography::Zero();

  // The same sight, dt_s after the frame's time.
  Sight at(double dt_s) const;
};

// The pixel of a point of the world at the frame's time. Empty behind the camera, beyond the lens's
// field, and beyond the horizon of the homography.
std::optional<Pixel> pixel_from_world(const Sight& sight, const Vector3& p_in_world);

// The silhouette points of a mesh, computed once for each aircraft.
struct SilhouettePoints {
  const model::Mesh* mesh = nullptr;
  // The result of model::silhouette_points(*mesh).
  std::vector<std::vector<Eigen::Vector3f>> points;
};

struct ExactBox {
  // Bounds of the points that have a pixel; empty when none has.
  std::optional<Box> box;
  // True where some points have no pixel (behind the camera or beyond the lens's field).
  bool partly_unseen = false;

  // The box where all points have a pixel: a shape that reaches through the camera's plane has no
  // bounds.
  std::optional<Box> whole() const { return partly_unseen ? std::nullopt : box; }
};

// Bounding box of the projected silhouette, in frame pixels and not clipped: it contains everything
// that the silhouette sweeps during the exposure, each row at its own time. `body`: the aircraft's
// motion within the frame. The box comes from geometry alone and never from rendered pixels, so
// that it is independent of the box that comes from the picture.
ExactBox exact_box(const Sight& sight,
                   const SilhouettePoints& silhouette,
                   const Rigid& world_from_body,
                   double time_s,
                   const Twist& body = {});

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
// the time is that of the point's own row. Under a homography other than the identity the result is
// empty for a point that no pixel shows (behind the camera, beyond the lens's field).
std::optional<Bearing> seen_bearing(const Sight& sight,
                                    const Vector3& p_in_world,
                                    const Vector3& velocity_in_world_mps);

}  // namespace airtruth::projection
