// SPDX-License-Identifier: Apache-2.0
// How many pixels an aircraft spans at a range, through a lens, with airtruth as a library.
#include <cstdio>

#include "camera/lens/lens.h"
#include "world/trajectory/path.h"

int main() {
  const airtruth::lens::Lens lens = airtruth::lens::pinhole_from_vertical_fov(41.4, {640, 480});
  const airtruth::Vector3 waypoints[] = {{200, -50, -150}, {400, 50, -150}};
  const auto path = airtruth::trajectory::spline_at_speed(waypoints, 60);
  for (double t = 0; t <= path.end_s(); t += 1) {
    const auto state = path.at(t);
    const double range_m = state->position_in_world.norm();
    std::printf(
        "%4.1f s  %6.1f m  %5.2f px for 11 m\n", t, range_m, lens.focal_px() * 11 / range_m);
  }
}
