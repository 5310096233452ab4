// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/place.h"

#include <gtest/gtest.h>

#include "scene/trajectory/path.h"

namespace airtruth::match {
namespace {

// A level aircraft as a camera that looks up by 40 degrees has it: turned down by as much.
TEST(Place, ACameraLooksUpByAsMuchAsHasTheAircraftLevel) {
  for (const double yaw_deg : {0.0, 75.0, -140.0})
    for (const double pitch_deg : {0.0, 15.0, 40.0, 60.0}) {
      const Quaternion seen =
          world_from_body({0, pitch_deg, 0}).conjugate() * world_from_body({yaw_deg, 0, 0});
      EXPECT_EQ(camera_pitch_deg(yaw_pitch_roll(seen)), pitch_deg) << yaw_deg;
    }
  // Seen from above: no camera on the ground looks down.
  EXPECT_EQ(
      camera_pitch_deg(yaw_pitch_roll(world_from_body({0, 30, 0}) * world_from_body({90, 0, 0}))),
      0);
}

// What the camera sees stays: the same direction and attitude within its own axes.
TEST(Place, LookingUpKeepsThePicture) {
  const Vector3 point(500, 20, -10);
  const YawPitchRoll before{30, -35, 10};
  Beside path{{point}, {0}};
  YawPitchRoll attitude = before;
  look_up(35, path, attitude);
  const Quaternion world_from_camera_body = world_from_body({0, 35, 0});
  EXPECT_TRUE((world_from_camera_body.conjugate() * path.waypoints_ned_m[0]).isApprox(point, 1e-9));
  EXPECT_NEAR((world_from_camera_body.conjugate() * world_from_body(attitude))
                  .angularDistance(world_from_body(before)),
              0,
              1e-7);
}

TEST(Place, SettingOffKeepsThePictureAndHasTheVelocityOverGround) {
  Beside path{{{500, -20, -90}, {510, 20, -87}, {500, 50, -80}}, {0, 1, 2}};
  const Beside before = path;
  const Vector3 cruise(30, 120, 0);
  set_off(cruise, path);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 camera = path.times_s[i] * path.camera_velocity_ned_mps;
    EXPECT_TRUE((path.waypoints_ned_m[i] - camera).isApprox(before.waypoints_ned_m[i], 1e-12));
    EXPECT_EQ(path.waypoints_ned_m[i].z(), before.waypoints_ned_m[i].z());
  }
  const auto first = trajectory::spline_at_times(path.waypoints_ned_m, path.times_s).at(0);
  EXPECT_TRUE(first->velocity_in_world_mps.head<2>().isApprox(cruise.head<2>(), 1e-12));
}

}  // namespace
}  // namespace airtruth::match
