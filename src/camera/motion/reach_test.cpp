// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/reach.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace airtruth::motion {
namespace {

constexpr int kReachWidth = 640;
constexpr int kReachHeight = 480;
constexpr double kFocalPx = 500;

// A pinhole that turns right: H = K R K^-1, scaled to h33 = 1 as the estimator does.
FrameMotion turned(int frame, double yaw_deg) {
  Homography k;
  k << kFocalPx, 0, kReachWidth / 2.0, 0, kFocalPx, kReachHeight / 2.0, 0, 0, 1;
  const Eigen::AngleAxisd cam_from_reference(-radians(yaw_deg), Vector3::UnitY());
  const Homography h = k * cam_from_reference.toRotationMatrix() * k.inverse();
  FrameMotion motion;
  motion.frame = frame;
  motion.time_s = frame / 30.0;
  motion.frame_from_reference = h / h(2, 2);
  motion.state = frame == 0 ? State::kReference : State::kMeasured;
  return motion;
}

// At the right edge the denominator is cos(yaw) - 320/500 sin(yaw): 0.153 at 50 degrees, 0.049 at
// 55, and below 0 from 57.4 degrees on, where the edge's rays are square to the reference's axis.
TEST(Reach, EndsWhereTheFrameLeavesThePlane) {
  const double yaw_deg[] = {0, 30, 50, 55, 89, 91, 180, -50, -55, 20};
  const bool within[] = {true, true, true, false, false, false, false, true, false, true};
  std::vector<FrameMotion> all;
  for (int k = 0; k < 10; ++k) all.push_back(turned(k, yaw_deg[k]));
  const std::vector<FrameMotion> held = within_reach(all, kReachWidth, kReachHeight);
  for (std::size_t k = 0; k < held.size(); ++k) {
    EXPECT_EQ(is_known(held[k].state), within[k]) << yaw_deg[k];
    if (within[k]) continue;
    EXPECT_EQ(held[k].state, State::kTurnedAway) << yaw_deg[k];
    std::size_t last = k;
    while (!within[last]) --last;
    EXPECT_EQ(held[k].frame_from_reference, all[last].frame_from_reference) << yaw_deg[k];
  }
}

TEST(Reach, ARotationHasNone) {
  FrameMotion motion = turned(0, 120);
  motion.rotation = Quaternion(Eigen::AngleAxisd(radians(120), Vector3::UnitY()));
  motion.state = State::kMeasured;
  EXPECT_EQ(within_reach({motion}, kReachWidth, kReachHeight)[0].state, State::kMeasured);
}

// A turn at a steady rate has no shake, even where h33 changes its sign.
TEST(Reach, TheSmoothedReferenceNeedsNone) {
  std::vector<FrameMotion> all;
  for (int k = 0; k < 120; ++k) all.push_back(turned(k, 0.25 + 1.5 * k));
  Options options;
  options.smoothing_s = 0.1;
  const std::vector<FrameMotion> steady = smoothed(all, options);
  for (std::size_t k = 10; k + 10 < steady.size(); ++k)
    for (const Pixel& p : {Pixel(0, 0), Pixel(640, 480), Pixel(320, 240)})
      EXPECT_LT((apply(steady[k].frame_from_reference, p) - p).norm(), 0.05) << k;
}

}  // namespace
}  // namespace airtruth::motion
