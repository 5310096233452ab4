// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "aircraft/model/mesh.h"
#include "camera/lens/lens.h"
#include "comparison/match/real.h"

namespace airtruth::match {

// Waypoints and times on which an aircraft of that mesh stays beside the real one, `scale` times as
// large, in the view of a camera at the origin that looks north and stands still. Time 0 is the
// frame of the first box. Throws Error where there is no room beside the real aircraft.
struct Beside {
  std::vector<Vector3> waypoints_ned_m;
  std::vector<double> times_s;
  Vector3 camera_velocity_ned_mps = Vector3::Zero();
};
Beside path_beside(const RealBoxes& boxes,
                   const model::Mesh& mesh,
                   const YawPitchRoll& attitude,
                   const lens::Lens& lens,
                   double frame_rate_hz,
                   double scale = 1);

// Returns the upward pitch, 0 to 60 degrees, of a camera that sees an aircraft in that attitude
// (which is stated for a level camera): the pitch at which the aircraft is most nearly upright.
// Light comes from above in the world and not in the picture, and most aircraft that are filmed
// from the ground fly level.
double camera_pitch_deg(const YawPitchRoll& attitude);

// Rotates the world so that the picture stays the same and the camera looks up by that angle.
void look_up(double pitch_deg, Beside& path, YawPitchRoll& attitude);

// Moves camera and aircraft along level ground so that the picture stays the same and the aircraft
// sets off with that velocity over ground.
void set_off(const Vector3& level_ned_mps, Beside& path);

}  // namespace airtruth::match
