// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "aircraft/model/mesh.h"
#include "camera/lens/lens.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/within_frame.h"

namespace airtruth::annotation {

// How a frame is seen: docs/architecture.md's ray in reverse, world to pixel.
struct Sight {
  const lens::Lens* lens = nullptr;
  Rigid cam_from_world;  // at the frame's time, as are all that have no other
  Homography frame_from_nominal = Homography::Identity();
  // What goes on within the frame.
  Shutter shutter;
  Twist camera;  // of world_from_cam
  Homography frame_from_nominal_per_s = Homography::Zero();

  Sight at(double dt_s) const;  // the same, dt_s from the frame's time
};

// Where a point of the world is seen at the frame's time; empty behind the camera, beyond the
// lens's field, or beyond H's horizon.
std::optional<Pixel> pixel_from_world(const Sight& sight, const Vector3& p_in_world);

// The silhouette points of a mesh, prepared once per aircraft.
struct Silhouette {
  const aircraft::Mesh* mesh = nullptr;
  std::vector<std::vector<Eigen::Vector3f>> points;  // aircraft::silhouette_points(*mesh)
};

struct ExactBox {
  std::optional<Box> box;  // of the points that have a pixel; empty when none has
  bool partly_unseen =
      false;  // some points have no pixel (behind the camera or beyond the lens's field)
};

// Bounding box of the projected silhouette, in frame pixels, not clipped: of all that the shutter
// lets it sweep, each row at its own time. `body`: how the aircraft goes on within the frame. Never
// looks at rendered pixels: it is the other of the two independent answers for the box.
ExactBox exact_box(const Sight& sight,
                   const Silhouette& silhouette,
                   const Rigid& world_from_body,
                   double time_s,
                   const Twist& body = {});

}  // namespace airtruth::annotation
