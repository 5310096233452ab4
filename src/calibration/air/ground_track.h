// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// Estimates the path of a camera over level ground from the pictures of the ground alone.
namespace airtruth::air {

// The largest error, degrees, that is searched for in the horizon of the views.
constexpr double kMaxTiltDeg = 6;

struct GroundView {
  // The picture must outlive the view.
  const image::Picture* picture = nullptr;
  // The world frame is north-east-down.
  Quaternion cam_from_world;
};

// Views through one lens; own_aircraft masks them all, where it is not nullptr.
struct Scenery {
  const std::vector<GroundView>& views;
  const lens::Lens& lens;
  const image::Mask* own_aircraft = nullptr;
};

// The path of the camera. Places are north and east of the first view, in heights: multiples of the
// camera's height above the ground.
struct GroundTrack {
  // Index of the view to which places[0] belongs.
  std::size_t first = 0;
  // The places of consecutive views.
  std::vector<Eigen::Vector2d> places;
  // Elevation of the true horizon above the horizon of the views, in the direction of view; haze
  // lowers the visible horizon. `level_from_world` is the same correction as a rotation about the
  // axis to the right of the views.
  double horizon_rad = 0;
  Quaternion level_from_world = Quaternion::Identity();
  // Correlation between the aligned views, -1 to 1.
  double agreement = 0;
};

// Projects each view onto the ground plane, equalises its contrast and registers it with the next
// one by masked correlation (Padfield 2012, "Masked object registration in the Fourier domain").
// The horizon is the one under which views that are farther apart agree best. Empty where the views
// do not agree. Throws Interrupted when `stop` is requested.
std::optional<GroundTrack> track_ground(const Scenery& scenery, const std::stop_token& stop = {});

// The point at which a direction (z down) meets the ground, north and east of the point under the
// camera, in heights. Empty at the horizon and above.
std::optional<Eigen::Vector2d> place_on_ground(const Vector3& direction_in_level);

}  // namespace airtruth::air
