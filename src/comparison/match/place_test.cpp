// SPDX-License-Identifier: Apache-2.0
#include "comparison/match/place.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace airtruth::match
