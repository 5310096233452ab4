// SPDX-License-Identifier: Apache-2.0
#include "labels/projection/spot_box.h"

#include <cmath>

#include <gtest/gtest.h>

namespace airtruth::projection {
namespace {

TEST(SpotBox, ACircleHasTheDiameterOfHalfItsOpacity) {
  image::Spot spot;
  spot.centre = {100, 50};
  spot.radius_px = 20;
  spot.softness = 0.5;
  const Box box = spot_box(spot, {}, 640, 480);
  EXPECT_NEAR(box.x, 85, 1e-9);
  EXPECT_NEAR(box.y, 35, 1e-9);
  EXPECT_NEAR(box.width, 30, 1e-9);
  EXPECT_NEAR(box.height, 30, 1e-9);
}

TEST(SpotBox, ACapsuleReachesAlongItsDirection) {
  image::Spot spot;
  spot.centre = {100, 50};
  spot.radius_px = 5;
  spot.half_length_px = 10;
  spot.direction = Pixel(0.6, -0.8);
  const Box box = spot_box(spot, {}, 640, 480);
  EXPECT_NEAR(box.width, 2 * (5 + 6), 1e-9);
  EXPECT_NEAR(box.height, 2 * (5 + 8), 1e-9);
}

// Wings across it reach 20 px and half of their radius to either side.
TEST(SpotBox, WingsReachAcross) {
  image::Spot spot;
  spot.centre = {100, 50};
  spot.radius_px = 5;
  spot.half_length_px = 10;
  spot.wing_px = 20;
  spot.wing_radius_px = 8;
  const Box box = spot_box(spot, {}, 640, 480);
  EXPECT_NEAR(box.width, 2 * (5 + 10), 1e-9);
  EXPECT_NEAR(box.height, 2 * (20 + 4), 1e-9);
}

TEST(SpotBox, TheExposureSweepsItAndTheRowShiftsIt) {
  image::Spot spot;
  spot.centre = {100, 240};
  spot.radius_px = 5;
  spot.velocity_px_s = {1000, 0};
  EXPECT_NEAR(spot_box(spot, {.exposure_s = 0.02}, 640, 480).width, 10 + 20, 1e-9);
  // The middle row is read at the frame's time, a row a quarter of the height lower later.
  const Shutter rolling{.exposure_s = 0, .readout_s = 0.02};
  EXPECT_NEAR(spot_box(spot, rolling, 640, 480).x, 95, 0.1);
  spot.centre = {100, 360};
  EXPECT_NEAR(spot_box(spot, rolling, 640, 480).x, 95 + 1000 * 0.02 / 4, 0.1);
}

// A circle moves by 3/8 of a row while one row is read. Where it falls, it is 1 / (1 - 3/8) times
// as high; where it goes across, it is sheared by 3/8.
TEST(SpotBox, EachRowOfARollingShutterSeesItAtItsOwnTime) {
  const Shutter rolling{.exposure_s = 0, .readout_s = 0.03};
  image::Spot spot;
  spot.centre = {300, 240};
  spot.radius_px = 40;
  spot.velocity_px_s = {0, 6000};
  const Box fallen = spot_box(spot, rolling, 640, 480);
  EXPECT_NEAR(fallen.height, 80 / (1 - 0.375), 0.7);
  EXPECT_NEAR(fallen.width, 80, 1e-9);
  spot.velocity_px_s = {6000, 0};
  const Box sheared = spot_box(spot, rolling, 640, 480);
  EXPECT_NEAR(sheared.width, 80 * std::hypot(1, 0.375), 0.5);
  EXPECT_NEAR(sheared.height, 80, 1e-9);
}

TEST(SpotBox, LobesMoveTheOutline) {
  image::Spot spot;
  spot.radius_px = 10;
  spot.cosines[0] = 0.2;  // longer across, shorter down
  const Box box = spot_box(spot, {}, 640, 480);
  EXPECT_NEAR(box.width, 24, 1e-3);
  EXPECT_LT(box.height, 18);
}

}  // namespace
}  // namespace airtruth::projection
