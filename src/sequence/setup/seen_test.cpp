// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/seen.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/shared_inputs.h"
#include "sequence/setup/world.h"
#include "support/error_of.h"

namespace airtruth::setup {
namespace {

constexpr double kRate_hz = 30;

scene::Seen at_range(double time_s, const Pixel& pixel, double range_m) {
  scene::Seen seen;
  seen.time_s = time_s;
  seen.pixel = pixel;
  seen.range_m = range_m;
  seen.where = {"s.toml", 8, 1};
  return seen;
}

scene::Seen at_width(double time_s, const Pixel& pixel, double width_px) {
  scene::Seen seen = at_range(time_s, pixel, 1);
  seen.range_m.reset();
  seen.width_px = width_px;
  return seen;
}

scene::Intruder cessna(std::vector<scene::Seen> seen) {
  scene::Intruder intruder;
  intruder.id = "one";
  intruder.aircraft = "c172/news";
  intruder.seen = std::move(seen);
  intruder.where = {"s.toml", 6, 1};
  return intruder;
}

// A camera that shakes by up to a degree about every axis, at 30 frames a second.
Shake rotation_of(double time_s) {
  Shake shake;
  shake.rotation = rotation_from_vector(
      radians(1) * Vector3(std::sin(11 * time_s), std::cos(7 * time_s), std::sin(17 * time_s)));
  shake.rate_radps = radians(1) * Vector3(11 * std::cos(11 * time_s), 0, 3);
  return shake;
}

Shake homography_of(double time_s) {
  Shake shake;
  shake.frame_from_reference << 1 + 0.02 * std::sin(time_s), 0.03, 9 * std::sin(5 * time_s), -0.02,
      1, -6, 2e-5, -1e-5, 1;
  return shake;
}

FrameNear frames(Shake (*shake_of)(double)) {
  return [shake_of](const scene::Seen& seen) {
    const double time_s = std::round(seen.time_s * kRate_hz) / kRate_hz;
    return FramePose{time_s, shake_of(time_s)};
  };
}

// The pixel that shows the path at a frame, by the projection that draws and describes frames.
Pixel pixel_at(const World& world,
               const trajectory::Path& path,
               double time_s,
               const Shake& shake) {
  const Moment moment = moment_at(world, 0, time_s, shake);
  const trajectory::State state = *path.at(time_s);
  Pixel pixel = *projection::pixel_from_world(moment.sight, state.position_in_world);
  // The row of the point, by iteration.
  for (int round = 0; round < 8 && world.shutter.readout_s > 0; ++round) {
    const double dt_s =
        world.shutter.middle_s(pixel, world.lens.size().width, world.lens.size().height);
    pixel = *projection::pixel_from_world(moment.sight.at(dt_s),
                                          path.at(time_s + dt_s)->position_in_world);
  }
  return pixel;
}

World empty_world(const lens::Lens& lens) {
  return {lens,
          trajectory::uniform({0, 0, -150}, {25, 3, -1}, {.yaw_deg = 20, .pitch_deg = -4}),
          {},
          {}};
}

const std::vector<scene::Seen> kThree = {at_range(0.5, {210, 160}, 800),
                                         at_range(2.02, {400.25, 190}, 600),
                                         at_range(4, {700, 20}, 350)};

void expect_seen_where_stated(const World& world, Shake (*shake_of)(double)) {
  const scene::Intruder placed = placed_as_seen(cessna(kThree), world, frames(shake_of), nullptr);
  EXPECT_TRUE(placed.seen.empty());
  const trajectory::Path path = path_of(placed, world.camera);
  for (const scene::Seen& seen : kThree) {
    const double frame_s = std::round(seen.time_s * kRate_hz) / kRate_hz;
    const Pixel pixel = pixel_at(world, path, frame_s, shake_of(frame_s));
    EXPECT_LT((pixel - seen.pixel).norm(), 1e-6) << seen.time_s;
    if (world.shutter.readout_s > 0) continue;
    const double range_m =
        (path.at(frame_s)->position_in_world - world.camera.at(frame_s)->position_in_world).norm();
    EXPECT_NEAR(range_m, *seen.range_m, 1e-6);
  }
}

TEST(Seen, ThePathPassesEveryPixelThroughLensAndRotation) {
  const lens::ImageSize size{1280, 720};
  expect_seen_where_stated(empty_world(lens::pinhole_from_vertical_fov(50, size)), rotation_of);
  expect_seen_where_stated(empty_world(lens::fisheye_from_vertical_fov(120, size)), rotation_of);
  const lens::BrownConrady wide{{700, 700}, {640, 360}, {-0.2, 0.03, 1e-3, -5e-4}};
  expect_seen_where_stated(empty_world(lens::Lens(wide, size)), rotation_of);
}

TEST(Seen, ThePathPassesEveryPixelThroughAHomography) {
  expect_seen_where_stated(empty_world(lens::pinhole_from_vertical_fov(50, {1280, 720})),
                           homography_of);
}

TEST(Seen, WithARollingShutterThePixelIsThatOfItsRow) {
  World world = empty_world(lens::pinhole_from_vertical_fov(50, {1280, 720}));
  world.shutter.readout_s = 0.025;
  expect_seen_where_stated(world, rotation_of);
}

// The legs beyond the first and the last moment leave the curve between them as it is.
TEST(Seen, ThePathGoesOnStraightBeyondItsEnds) {
  const World world = empty_world(lens::pinhole_from_vertical_fov(50, {1280, 720}));
  const scene::Intruder placed = placed_as_seen(cessna(kThree), world, steady_frame, nullptr);
  const trajectory::Path path = path_of(placed, world.camera);
  std::vector<Vector3> places(placed.waypoints_ned_m.begin() + 1, placed.waypoints_ned_m.end() - 1);
  std::vector<double> times_s(placed.times_s.begin() + 1, placed.times_s.end() - 1);
  const trajectory::Path inner = trajectory::spline_at_times(places, times_s);
  for (const double t : {0.6, 1.7, 3.2, 3.99})
    EXPECT_LT((path.at(t)->position_in_world - inner.at(t)->position_in_world).norm(), 1e-6);
  const Vector3 at_end = path.at(4)->velocity_in_world_mps;
  EXPECT_LT((path.at(60)->velocity_in_world_mps - at_end).norm(), 1e-6);
  EXPECT_TRUE(path.at(-60));
}

TEST(Seen, AWidthIsThatOfTheExactBox) {
  scene::Scene scene;
  scene.lens.vertical_fov_deg = 50;
  scene.camera.velocity_ned_mps = {25, 0, 0};
  scene.intruders = {cessna({at_width(0.5, {210, 160}, 14), at_width(3, {700, 300}, 40)})};
  const World world = load_world(scene, {1280, 720}, {});
  for (const scene::Seen& seen : scene.intruders[0].seen) {
    const Moment moment = moment_at(world, 0, seen.time_s, {});
    const Box& box = *moment.boxes[0].box;
    EXPECT_NEAR(box.width, *seen.width_px, 2e-3 * *seen.width_px);
    EXPECT_NEAR(box.x + box.width / 2, seen.pixel.x(), 2 * kMiddlePx);
    EXPECT_NEAR(box.y + box.height / 2, seen.pixel.y(), 2 * kMiddlePx);
  }
}

// Its origin is far below it, as that of an airliner on its wheels is. Through a rolling shutter
// and a shaking camera the box of the whole exposure counts.
TEST(Seen, TheMiddleOfTheBoxIsAtThePixelWhereverTheModelsOriginIs) {
  scene::Scene scene;
  scene.lens.vertical_fov_deg = 50;
  scene.camera.velocity_ned_mps = {25, 0, 0};
  scene.camera_model.exposure_s = 0.008;
  scene.camera_model.readout_s = 0.02;
  scene.intruders = {cessna(kThree)};
  scene.intruders[0].aircraft = "738/738-ANA";
  World world = load_world(scene, {1280, 720}, {});
  place_seen(scene, world, frames(rotation_of), {});
  for (const scene::Seen& seen : kThree) {
    const double time_s = std::round(seen.time_s * kRate_hz) / kRate_hz;
    const Moment moment = moment_at(world, 0, time_s, rotation_of(time_s));
    const Box& box = *moment.boxes[0].box;
    EXPECT_NEAR(box.x + box.width / 2, seen.pixel.x(), 0.01);
    EXPECT_NEAR(box.y + box.height / 2, seen.pixel.y(), 0.01);
    const Vector3 off = moment.states[0]->position_in_world - moment.camera.position_in_world;
    EXPECT_NEAR(off.norm(), *seen.range_m, 1.5);  // of the pixel's row, some 10 ms from the frame
  }
}

TEST(Seen, ABirdOfAFlockKeepsItsOffset) {
  scene::Scene scene;
  scene.lens.vertical_fov_deg = 50;
  scene.intruders = {cessna(kThree), cessna(kThree)};
  scene.intruders[1].offset_ned_m = {5, 30, -8};
  World world = load_world(scene, {1280, 720}, {});
  place_seen(scene, world, frames(rotation_of), {});
  for (const double time_s : {0.5, 1.3, 4.0}) {
    const Vector3 off = world.actors[1].path.at(time_s)->position_in_world -
                        world.actors[0].path.at(time_s)->position_in_world;
    EXPECT_LT((off - scene.intruders[1].offset_ned_m).norm(), 1e-6);
  }
}

TEST(Seen, PlacingByTheMeasuredMotionMovesPathAndScene) {
  scene::Scene scene;
  scene.lens.vertical_fov_deg = 50;
  scene.intruders = {cessna(kThree)};
  SharedInputs shared;
  World world = load_world(scene, {1280, 720}, {}, {}, &shared);
  const auto model = world.actors[0].type->model;
  const Vector3 steady = world.actors[0].path.at(1)->position_in_world;
  place_seen(scene, world, frames(rotation_of), {}, &shared);
  EXPECT_TRUE(scene.intruders[0].seen.empty());
  EXPECT_GT((world.actors[0].path.at(1)->position_in_world - steady).norm(), 1);
  EXPECT_EQ(world.actors[0].type->model, model);  // the same shape keeps its BVH
  const trajectory::Path recorded = path_of(scene.intruders[0], world.camera);
  EXPECT_EQ(recorded.at(1)->position_in_world, world.actors[0].path.at(1)->position_in_world);
}

// ------------------------------------------------------------------------------------ bad input

std::string message_of(const std::vector<scene::Seen>& seen) {
  const World world = empty_world(lens::pinhole_from_vertical_fov(50, {1280, 720}));
  return test_support::error_of(
      [&] { placed_as_seen(cessna(seen), world, frames(rotation_of), nullptr); });
}

TEST(Seen, SaysWhatCannotBe) {
  EXPECT_EQ(message_of({at_range(1, {0, 0}, 900), at_range(1.01, {9, 9}, 900)}),
            "s.toml:8:1: time_s is 1.010, whose frame, at 1.000 s, is that of the moment before; "
            "expected another frame");
  EXPECT_NE(message_of({at_range(0, {0, 0}, 9e5), at_range(1, {1280, 0}, 9e5)})
                .find("m/s; expected less than 10000 m/s"),
            std::string::npos);
}

TEST(Seen, APixelBeyondTheLensIsAnError) {
  const World world = empty_world(lens::fisheye_from_vertical_fov(100, {1280, 720}));
  try {
    placed_as_seen(cessna({at_range(0, {1e4, 0}, 900), at_range(1, {9, 9}, 900)}),
                   world,
                   steady_frame,
                   nullptr);
    FAIL() << "expected an error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "s.toml:8:1: pixel [10000, 0] is beyond the lens's field; expected a pixel that "
                 "the lens shows");
  }
}

}  // namespace
}  // namespace airtruth::setup
