// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "foundation/geometry/box.h"
#include "foundation/geometry/transform.h"

namespace airtruth {
namespace {

TEST(Attitude, AxesPointWhereTheConventionsSay) {
  EXPECT_TRUE(
      (world_from_body({90, 0, 0}) * Vector3::UnitX()).isApprox(Vector3::UnitY()));  // nose east
  EXPECT_TRUE(
      (world_from_body({0, 90, 0}) * Vector3::UnitX()).isApprox(-Vector3::UnitZ()));  // nose up
  EXPECT_TRUE((world_from_body({0, 0, 90}) * Vector3::UnitY())
                  .isApprox(Vector3::UnitZ()));  // right wing down
}

TEST(Attitude, RoundTripsOverAGrid) {
  for (double yaw = -175; yaw < 180; yaw += 35) {
    for (double pitch = -85; pitch < 90; pitch += 17) {
      for (double roll = -170; roll < 180; roll += 45) {
        const YawPitchRoll back = yaw_pitch_roll(world_from_body({yaw, pitch, roll}));
        EXPECT_NEAR(back.yaw_deg, yaw, 1e-9);
        EXPECT_NEAR(back.pitch_deg, pitch, 1e-9);
        EXPECT_NEAR(back.roll_deg, roll, 1e-9);
      }
    }
  }
}

TEST(Attitude, StraightUpKeepsTheRotation) {
  const Quaternion q = world_from_body({30, 90, 20});
  EXPECT_LT(world_from_body(yaw_pitch_roll(q)).angularDistance(q), 1e-6);
}

TEST(Camera, LooksAlongTheNose) {
  EXPECT_TRUE((cam_from_body() * Vector3::UnitX()).isApprox(Vector3::UnitZ()));
  EXPECT_TRUE((cam_from_body() * Vector3::UnitY()).isApprox(Vector3::UnitX()));
  EXPECT_TRUE((cam_from_body() * Vector3::UnitZ()).isApprox(Vector3::UnitY()));
}

TEST(Rigid, InverseUndoesAndProductsCompose) {
  const Rigid b_from_a{world_from_body({10, 20, 30}), {1, 2, 3}};
  const Rigid c_from_b{world_from_body({-70, 5, 100}), {-4, 0, 9}};
  const Vector3 p(0.3, -8, 2);
  EXPECT_TRUE((b_from_a.inverse() * (b_from_a * p)).isApprox(p));
  EXPECT_TRUE(((c_from_b * b_from_a) * p).isApprox(c_from_b * (b_from_a * p)));
}

TEST(Homography, TranslationMovesAPixel) {
  Homography h = Homography::Identity();
  h(0, 2) = 3;
  h(1, 2) = -2;
  EXPECT_TRUE(apply(h, {10, 20}).isApprox(Pixel(13, 18)));
}

TEST(Box, BoundsOfPointsAndPixels) {
  BoxBounds grow;
  EXPECT_FALSE(grow.box());
  grow.add({1, 5});
  grow.add({4, 2});
  EXPECT_EQ(grow.box(), (Box{1, 2, 3, 3}));
  EXPECT_EQ(intersection({0, 0, 4, 4}, {2, 3, 9, 9}), (PixelBox{2, 3, 2, 1}));
  EXPECT_EQ(intersection({0, 0, 4, 4}, {4, 0, 2, 2}), std::nullopt);
  EXPECT_EQ(bounds({0, 0, 1, 1}, {5, 6, 2, 2}), (PixelBox{0, 0, 7, 8}));
}

}  // namespace
}  // namespace airtruth
