// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/world.h"

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/temporary_folder.h"

namespace airtruth::setup {
namespace {

scene::Intruder flying(const std::string& id, const std::string& aircraft, double speed_mps) {
  scene::Intruder intruder;
  intruder.id = id;
  intruder.aircraft = aircraft;
  intruder.waypoints_ned_m = {{100, 0, -1000}, {400, 0, -1000}};
  intruder.speed_mps = speed_mps;
  return intruder;
}

scene::Scene scene_of(std::vector<scene::Intruder> intruders) {
  scene::Scene scene;
  scene.lens.vertical_fov_deg = 40;
  scene.intruders = std::move(intruders);
  return scene;
}

TEST(LoadWorld, OneLookAtTwoSpeedsIsOneMeshAndOneBvh) {
  const World world = load_world(
      scene_of({flying("slow", "738/738-Ryanair", 110), flying("fast", "738/738-Ryanair", 160)}),
      {320, 240},
      {});
  ASSERT_EQ(world.actors.size(), 2u);
  EXPECT_EQ(world.actors[0].type, world.actors[1].type);
  EXPECT_EQ(world.actors[0].type->model, world.actors[1].type->model);
}

TEST(LoadWorld, TwoLiveriesAreTwoTypes) {
  const World world =
      load_world(scene_of({flying("a", "738/738-Ryanair", 110), flying("b", "738/738-KLM", 110)}),
                 {320, 240},
                 {});
  EXPECT_NE(world.actors[0].type->model, world.actors[1].type->model);
}

// Below 500 ft the gear is down (aircraft/wrapper/wrapper.h), which is another mesh.
TEST(LoadWorld, GearThatIsDownIsAnotherType) {
  scene::Intruder low = flying("low", "738/738-Ryanair", 70);
  low.waypoints_ned_m = {{100, 0, -60}, {400, 0, -60}};
  const World world =
      load_world(scene_of({flying("high", "738/738-Ryanair", 110), low}), {320, 240}, {});
  EXPECT_NE(world.actors[0].type->model, world.actors[1].type->model);
}

// What is seen within the clip flies on a path that climbs from the ground an hour before it.
TEST(LoadWorld, GearIsThatOfTheClipWhereAPathBeginsBeforeIt) {
  scene::Intruder climbing = flying("climbing", "738/738-Ryanair", 110);
  climbing.speed_mps.reset();
  climbing.waypoints_ned_m = {{-395900, 0, 0}, {100, 0, -1000}, {430, 0, -1000.8}};
  climbing.times_s = {-3600, 0, 3};
  const World world =
      load_world(scene_of({flying("level", "738/738-Ryanair", 110), climbing}), {320, 240}, {});
  EXPECT_EQ(world.actors[0].type, world.actors[1].type);
}

// 95 frames of 30/s last 3.2 s.
TEST(CameraPath, IsHeldAgainstAStatedNumberOfFramesAlone) {
  const test_support::TemporaryFolder folder;
  write_file(folder.path() / "path.csv",
             "time_s,north_m,east_m,down_m\n0,0,0,-150\n1.7,40,0,-150\n");
  scene::Scene scene = scene_of({});
  scene.camera.path_file = folder.path() / "path.csv";
  const World world = load_world(scene, {320, 240}, {});
  video::StreamInfo info;
  info.frame_count_estimate = 95;
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& text) { warnings.push_back(text); };
  EXPECT_NO_THROW(check_camera_path(world, info, warn));
  EXPECT_EQ(warnings.size(), 1U);
  info.is_frame_count_stated = true;
  EXPECT_THROW(check_camera_path(world, info, warn), Error);
}

}  // namespace
}  // namespace airtruth::setup
