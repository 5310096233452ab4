// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/layer.h"
#include "foundation/image/picture.h"

// Where a camera flew over level ground, from the ground alone.
namespace airtruth::calibration {

constexpr double kMostTiltDeg = 6;  // of the horizon that views are given

struct GroundView {
  const image::Picture* picture = nullptr;  // outlives the view
  Quaternion cam_from_world;                // north-east-down
};

// Places are in heights over the ground, north and east of the first view.
struct GroundTrack {
  std::size_t first = 0;                // view that places[0] is of
  std::vector<Eigen::Vector2d> places;  // of so many views one after the other
  // How far the true horizon lies above the one that the views were given, where they look: haze
  // draws it down. As a turn about the axis to their right.
  double horizon_rad = 0;
  Quaternion level_from_world = Quaternion::Identity();
  double agreement = 0;  // correlation of views at rest over one another, -1 to 1
};

// Each view is straightened to the plane, its contrast made even, and laid over the next one by
// correlation of what both show (Padfield 2012, "Masked object registration in the Fourier
// domain"). The horizon is where views farther apart agree best. Empty where they do not agree.
// Throws Interrupted.
std::optional<GroundTrack> track_ground(const std::vector<GroundView>& views,
                                        const lens::Lens& lens,
                                        const image::Mask* own_aircraft,
                                        const std::stop_token& stop = {});

// Where a direction (down positive in z) meets the ground, in heights from under the camera. Empty
// at the horizon and above.
std::optional<Eigen::Vector2d> place_on_ground(const Vector3& direction_in_level);

}  // namespace airtruth::calibration
