// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "aircraft/model/mesh.h"
#include "benchmark/comparison/comparison.h"
#include "camera/lens/lens.h"

namespace airtruth::comparison {

// Waypoints and times on which an aircraft of that mesh keeps beside the real one, `scale` times as
// large as it, in the view of a camera that stands at the origin and looks north. Time 0 is the
// first box's frame. Error where there is no room beside it.
struct Beside {
  std::vector<Vector3> waypoints_ned_m;
  std::vector<double> times_s;
};
Beside path_beside(const RealBoxes& boxes,
                   const aircraft::Mesh& mesh,
                   const YawPitchRoll& attitude,
                   const lens::Lens& lens,
                   double frame_rate_hz,
                   double scale = 1);

// How far a camera looks up, 0 to 60 degrees, that sees an aircraft in that attitude (as a level
// camera has it): where the aircraft is most nearly upright. Light comes from above in the world
// and not in the picture, and most of what is filmed from the ground flies level.
double camera_pitch_deg(const YawPitchRoll& attitude);

// The same picture with the world turned under it, so that the camera looks up by that much.
void look_up(double pitch_deg, Beside& path, YawPitchRoll& attitude);

}  // namespace airtruth::comparison
