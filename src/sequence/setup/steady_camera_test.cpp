// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/steady_camera.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "camera/motion/shake.h"
#include "foundation/geometry/transform.h"

namespace airtruth::setup {
namespace {

constexpr double kRateHz = 30;
constexpr int kFrames = 300;
constexpr double kTurnDps = 12;

// A camera that turns to the right, and shakes by a degree five times a second.
Quaternion flown(double time_s) {
  const double shake_deg = std::sin(2 * kPi * 5 * time_s);
  return world_from_body({40 + kTurnDps * time_s + shake_deg, -8 + shake_deg, 3 - shake_deg});
}

trajectory::Path flown_path(double end_s) {
  return trajectory::Path(-1, end_s, [](double time_s) {
    trajectory::State state;
    state.world_from_body = flown(time_s);
    return state;
  });
}

scene::Scene smoothed_scene() {
  scene::Scene scene;
  scene.motion.reference = scene::MotionReference::kSmoothed;
  scene.camera.path_file = "own.csv";
  return scene;
}

video::StreamInfo clip() {
  video::StreamInfo info;
  info.frame_rate = {30, 1};
  info.frame_count_estimate = kFrames;
  return info;
}

double degrees_between(const Quaternion& a, const Quaternion& b) {
  return degrees(vector_from_rotation(a * b.conjugate()).norm());
}

double yaw_deg(const trajectory::Path& path, double time_s) {
  return yaw_pitch_roll(path.at(time_s)->world_from_body).yaw_deg;
}

// What a video that shows exactly these attitudes has as its measured shake.
std::vector<motion::FrameMotion> measured() {
  std::vector<motion::FrameMotion> frames;
  for (int k = 0; k < kFrames; ++k) {
    motion::FrameMotion frame;
    frame.time_s = k / kRateHz;
    const Quaternion cam_from_world = cam_from_body() * flown(frame.time_s).conjugate();
    frame.rotation = cam_from_world * (cam_from_body() * flown(0).conjugate()).conjugate();
    frames.push_back(frame);
  }
  return motion::smoothed(frames, {});
}

TEST(SteadyCamera, WithTheMeasuredShakeIsTheCameraThatFlew) {
  const auto steady = steady_camera(flown_path(20), smoothed_scene(), clip());
  const auto shakes = measured();
  for (const motion::FrameMotion& frame : shakes) {
    const Quaternion cam_from_world =
        *frame.rotation * cam_from_body() * steady.at(frame.time_s)->world_from_body.conjugate();
    EXPECT_LT(degrees_between(cam_from_world.conjugate() * cam_from_body(), flown(frame.time_s)),
              1e-9)
        << "at " << frame.time_s << " s";
  }
}

// A window of a standard deviation of 1 s leaves nothing of a shake of 5 Hz, and all of a turn.
// Beside the first frame it is one-sided: the mean of exp(-t^2 / 2) from 0 to 2.5 is at 0.772 s.
TEST(SteadyCamera, TurnsAsTheMeanOfTheWindow) {
  const auto steady = steady_camera(flown_path(20), smoothed_scene(), clip());
  for (const double time_s : {3.0, 4.05, 5.117, 6.9})
    EXPECT_NEAR(yaw_deg(steady, time_s), 40 + kTurnDps * time_s, 0.05) << time_s;
  EXPECT_NEAR(yaw_deg(steady, 0), 40 + kTurnDps * 0.772, 0.3);
  const double last_s = (kFrames - 1) / kRateHz;
  EXPECT_NEAR(yaw_deg(steady, last_s), 40 + kTurnDps * (last_s - 0.772), 0.3);
}

// Rows of a rolling shutter are read before and after the time of their frame.
TEST(SteadyCamera, TurnsOnBesideTheFirstAndTheLastFrame) {
  const auto steady = steady_camera(flown_path(20), smoothed_scene(), clip());
  const double last_s = (kFrames - 1) / kRateHz;
  for (const double end_s : {0.0, last_s}) {
    const double before = yaw_deg(steady, end_s - 0.01), at = yaw_deg(steady, end_s);
    EXPECT_NEAR(yaw_deg(steady, end_s + 0.01) - at, at - before, 0.02);
    EXPECT_GT(at - before, 0.01);
  }
}

TEST(SteadyCamera, ALogThatEndsBeforeTheClipIsHeldThere) {
  const auto steady = steady_camera(flown_path(9.5), smoothed_scene(), clip());
  EXPECT_NEAR(yaw_deg(steady, 5), 40 + kTurnDps * 5, 0.05);
  EXPECT_DOUBLE_EQ(steady.end_s(), 9.5);
}

TEST(SteadyCamera, IsThePathWhereNothingIsAddedToItsAttitudes) {
  const auto path = flown_path(20);
  scene::Scene scene = smoothed_scene();
  scene.motion.model = scene::MotionModel::kNone;
  EXPECT_EQ(yaw_deg(steady_camera(path, scene, clip()), 1.05), yaw_deg(path, 1.05));
  scene = smoothed_scene();
  scene.motion.reference = scene::MotionReference::kFirstFrame;
  EXPECT_EQ(yaw_deg(steady_camera(path, scene, clip()), 1.05), yaw_deg(path, 1.05));
  scene = smoothed_scene();
  scene.camera.path_file.reset();
  EXPECT_EQ(yaw_deg(steady_camera(path, scene, clip()), 1.05), yaw_deg(path, 1.05));
}

}  // namespace
}  // namespace airtruth::setup
