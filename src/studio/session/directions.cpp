// SPDX-License-Identifier: Apache-2.0
#include "studio/session/directions.h"

#include <algorithm>
#include <cmath>

#include "foundation/geometry/units.h"
#include "labels/projection/exact_box.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"
#include "studio/session/answers.h"

namespace airtruth::session {
namespace {

// Steps between marks, in degrees, and how many of a step are across the picture at most.
constexpr int kStepsDeg[] = {1, 2, 5, 10, 15, 30};
constexpr double kMostAcross = 8;
// Of the picture's width: beyond this angle from the axis nothing is in it. Its diagonal is
// shorter.
constexpr double kReach = 1;
// Of what has no parallax.
constexpr double kFarAwayM = 1e7;

int step_deg(double view_deg) {
  for (const int step : kStepsDeg)
    if (view_deg <= kMostAcross * step) return step;
  return kStepsDeg[std::size(kStepsDeg) - 1];
}

}  // namespace

nlohmann::ordered_json directions_over(const Stage& stage, std::int64_t frame) {
  nlohmann::ordered_json marks = nlohmann::ordered_json::array();
  const auto sight = stage.sight_at(frame);
  if (!sight) return marks;
  const double view_deg = sight->lens->horizontal_fov_deg();
  const int step = step_deg(view_deg);
  const Rigid world_from_cam = sight->cam_from_world.inverse();
  const Vector3 axis = world_from_cam.rotation * Vector3(0, 0, 1);
  const double least = std::cos(radians(std::min(180.0, kReach * view_deg)));
  for (int elevation = -90 + step; elevation < 90; elevation += step)
    for (int azimuth = 0; azimuth < 360; azimuth += step) {
      const double a = radians(azimuth);
      const double e = radians(elevation);
      const Vector3 direction(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), -std::sin(e));
      if (direction.dot(axis) < least) continue;
      const auto pixel =
          projection::pixel_from_world(*sight, world_from_cam.translation + kFarAwayM * direction);
      if (pixel && setup::meets_frame({pixel->x(), pixel->y(), 0, 0}, sight->lens->size()))
        marks.push_back({azimuth, elevation, rounded(pixel->x(), 0.1), rounded(pixel->y(), 0.1)});
    }
  return marks;
}

}  // namespace airtruth::session
