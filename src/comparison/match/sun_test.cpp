// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/sun.h"

#include <cmath>

#include <gtest/gtest.h>

#include "comparison/appearance/segment.h"
#include "sequence/insertion/ambient.h"
#include "sequence/insertion/paint.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

namespace airtruth::match {
namespace {

constexpr int kWide = 320, kHigh = 240;

// An even blue sky.
image::Picture blue_sky() {
  image::Picture picture = image::make_picture(kWide, kHigh, {});
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x) picture.planes[0].row(y)[x] = 120;
  for (int y = 0; y < picture.planes[1].height; ++y)
    for (int x = 0; x < picture.planes[1].width; ++x)
      picture.planes[1].row(y)[x] = 150, picture.planes[2].row(y)[x] = 110;
  return picture;
}

// A 737 on its side of the view, 40 px, under a sun.
scene::Scene scene_under(double azimuth_deg, double elevation_deg) {
  scene::Scene scene;
  scene.name = "s";
  scene.lens.vertical_fov_deg = 10;
  scene.camera.position_ned_m = Vector3::Zero();
  scene.camera.attitude_yaw_pitch_roll_deg = YawPitchRoll{0, 20, 0};
  scene.light.sun_azimuth_deg = azimuth_deg;
  scene.light.sun_elevation_deg = elevation_deg;
  scene.intruders.resize(1);
  scene.intruders[0].id = "i";
  scene.intruders[0].aircraft = "738/738-Delta";
  const double range_m = 1300, up = std::sin(radians(20)), level = std::cos(radians(20));
  scene.intruders[0].waypoints_ned_m = {{range_m * level, -5, -range_m * up},
                                        {range_m * level, 5, -range_m * up}};
  scene.intruders[0].times_s = {0, 1};
  scene.intruders[0].yaw_deg = 90;
  scene.intruders[0].pitch_deg = 0;
  scene.intruders[0].roll_deg = 0;
  return scene;
}

// The found sun is not on the grid that is searched.
TEST(Sun, IsFoundFromAnInsertedAircraft) {
  constexpr double kSpacingDeg = 15;  // of the search: as near as it promises
  scene::Scene lit = scene_under(130, 40);
  lit.camera_model.point_spread_px = 0.8;
  image::Picture picture = blue_sky();
  const setup::World world = setup::load_world(lit, {kWide, kHigh}, {});
  const setup::Moment moment = setup::moment_at(world, 0, 0.5, {});
  ASSERT_TRUE(moment.boxes[0].box);
  insertion::AmbientEstimator ambient(lit.light, {}, nullptr);
  const insertion::Ambient light = ambient.next(picture, moment.sight, {});
  insertion::Painter(lit, world, insertion::Occluders()).paint(picture, moment, light);
  scene::Scene unlit = scene_under(0, 90);
  // Beside it, where the sky is free.
  for (Vector3& point : unlit.intruders[0].waypoints_ned_m) point.y() += 60;
  const auto seen = appearance::seen_in(picture, *moment.boxes[0].box);
  ASSERT_TRUE(seen);
  const auto fit = fit_sun(unlit, {{0.5, &picture, seen->box}}, kSpacingDeg);
  ASSERT_TRUE(fit);
  const auto towards = [](double azimuth_deg, double elevation_deg) {
    return unit_vector(azimuth_deg, elevation_deg);
  };
  const double apart_deg =
      degrees(std::acos(towards(fit->azimuth_deg, fit->elevation_deg).dot(towards(130, 40))));
  EXPECT_LT(apart_deg, kSpacingDeg);
  EXPECT_GT(fit->correlation, 0.95);
}

}  // namespace
}  // namespace airtruth::match
