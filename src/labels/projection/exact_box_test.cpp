// SPDX-License-Identifier: Apache-2.0
#include "labels/projection/exact_box.h"

#include <cmath>

#include <gtest/gtest.h>

namespace airtruth::projection {
namespace {

using lens::ImageSize;

constexpr ImageSize kSize{1280, 960};

// A camera that looks north: x_cam is east, y_cam is down, z_cam is north.
Sight looking_north(const lens::Lens& lens, const Vector3& position_ned_m = Vector3::Zero()) {
  const Rigid world_from_cam{cam_from_body().conjugate(), position_ned_m};
  return {&lens, world_from_cam.inverse(), Homography::Identity()};
}

// The corners of a cube of 2 m about the origin.
std::vector<Eigen::Vector3f> cube() {
  std::vector<Eigen::Vector3f> corners;
  for (const float x : {-1.f, 1.f})
    for (const float y : {-1.f, 1.f})
      for (const float z : {-1.f, 1.f}) corners.emplace_back(x, y, z);
  return corners;
}

struct Solid {
  model::Mesh mesh;
  SilhouettePoints silhouette;
  explicit Solid(std::vector<Eigen::Vector3f> points, const model::Part& part = {}) {
    mesh.parts.push_back(part);
    silhouette.points.push_back(std::move(points));
  }
  ExactBox seen(const Sight& sight, const Rigid& world_from_body, double time_s = 0) {
    silhouette.mesh = &mesh;
    return exact_box(sight, silhouette, world_from_body, time_s);
  }
};

Rigid at(double north, double east, double down) {
  return {Quaternion::Identity(), {north, east, down}};
}

void expect_box(const std::optional<Box>& box, const Box& expected, double tolerance = 1e-6) {
  ASSERT_TRUE(box);
  EXPECT_NEAR(box->x, expected.x, tolerance);
  EXPECT_NEAR(box->y, expected.y, tolerance);
  EXPECT_NEAR(box->width, expected.width, tolerance);
  EXPECT_NEAR(box->height, expected.height, tolerance);
}

// A vertical view of 90 degrees gives f = 480. The near face, 100 m ahead, spans 2 * 480 / 100 =
// 9.6 px about the centre.
TEST(ExactBox, OfACubeAheadIsItsNearFace) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  const ExactBox box = Solid(cube()).seen(looking_north(lens), at(101, 0, 0));
  EXPECT_FALSE(box.partly_unseen);
  expect_box(box.box, {640 - 4.8, 480 - 4.8, 9.6, 9.6});
}

TEST(ExactBox, IsNotClippedByTheFrame) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  const ExactBox box = Solid(cube()).seen(looking_north(lens), at(101, -201, 0));
  // The box extends from east -202 at the near face to -200 at the far one, 102 m ahead.
  expect_box(box.box, {640 - 480 * 2.02, 480 - 4.8, 480 * (2.02 - 200.0 / 102.0), 9.6});
}

TEST(ExactBox, BehindTheCameraHasNone) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  const ExactBox box = Solid(cube()).seen(looking_north(lens), at(-101, 0, 0));
  EXPECT_FALSE(box.box);
  EXPECT_TRUE(box.partly_unseen);
}

TEST(ExactBox, AroundTheCameraIsPartlyUnseen) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  const ExactBox box = Solid(cube()).seen(looking_north(lens), at(0, 0, 0));
  EXPECT_TRUE(box.partly_unseen);
  expect_box(box.box, {640 - 480, 0, 960, 960});  // the four corners ahead, at 45 degrees
}

// Equidistant: 180 degrees over 960 px give f = 960 / pi. A point at the angle theta lies f * theta
// from the centre.
TEST(ExactBox, ThroughAFisheyeReachesToTheSide) {
  const lens::Lens lens = lens::fisheye_from_vertical_fov(180, kSize);
  const double focal = 960 / kPi;
  const ExactBox box = Solid({{0, 0, 0}, {0, 0, 10}}).seen(looking_north(lens), at(0, 50, 0));
  EXPECT_FALSE(box.partly_unseen);
  // Both are at 90 degrees from the axis: one straight to the right, one turned down by atan(10 /
  // 50).
  const double radius = focal * kPi / 2;
  const double turn = std::atan2(10.0, 50.0);
  expect_box(
      box.box,
      {640 + radius * std::cos(turn), 480, radius * (1 - std::cos(turn)), radius * std::sin(turn)});
}

TEST(ExactBox, FollowsThePosesOfCameraAndBody) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  // A rod of 10 m along the body's x axis, heading east, 100 m north of a camera at another place.
  const Rigid world_from_body{airtruth::world_from_body({90, 0, 0}), {1100, 2000, -300}};
  const ExactBox box =
      Solid({{-5, 0, 0}, {5, 0, 0}}).seen(looking_north(lens, {1000, 2000, -300}), world_from_body);
  expect_box(box.box, {640 - 24, 480, 48, 0}, 1e-4);
}

TEST(ExactBox, MovesWithTheHomography) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  Sight sight = looking_north(lens);
  sight.frame_from_nominal << 2, 0, 7, 0, 2, -3, 0, 0, 1;
  expect_box(Solid(cube()).seen(sight, at(101, 0, 0)).box,
             {2 * 635.2 + 7, 2 * 475.2 - 3, 19.2, 19.2});
}

TEST(ExactBox, BeyondTheHorizonOfTheHomographyIsUnseen) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  Sight sight = looking_north(lens);
  sight.frame_from_nominal << 1, 0, 0, 0, 1, 0, -1.0 / 1000, 0, 1;  // horizon at x = 1000
  EXPECT_TRUE(pixel_from_world(sight, {100, 0, 0}));
  EXPECT_FALSE(pixel_from_world(sight, {100, 80, 0}));  // x = 640 + 384
  EXPECT_FALSE(pixel_from_world(sight, {-100, 0, 0}));
}

// A blade of 2 m that turns about the nose, upright at 0 s.
Solid spinning_blade(double revolutions_per_s) {
  model::Part propeller;
  propeller.spins = true;
  propeller.revolutions_per_s = revolutions_per_s;
  return Solid({{0, 0, -1}, {0, 0, 1}}, propeller);
}

// A blade that turns once a second about the nose: it is upright at 0 s and level at 0.25 s.
TEST(ExactBox, TurnsWithASpinningPart) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  Solid blade = spinning_blade(1);
  const Sight sight = looking_north(lens);
  expect_box(blade.seen(sight, at(96, 0, 0), 0).box, {640, 475, 0, 10}, 1e-4);
  expect_box(blade.seen(sight, at(96, 0, 0), 0.25).box, {635, 480, 10, 0}, 1e-4);
  expect_box(blade.seen(sight, at(96, 0, 0), 0.125).box,
             {640 - 5 * std::sqrt(0.5),
              480 - 5 * std::sqrt(0.5),
              10 * std::sqrt(0.5),
              10 * std::sqrt(0.5)},
             1e-4);
}

// The blade turns 25 times a second, 4.8 m ahead: its tips are 100 px from the middle.
// The sensor is read within half a turn of it, in which time each row sees the blade where it then
// is.
TEST(ExactBox, OfASpinningPartIsWhereTheRowsSeeIt) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(90, kSize);
  Solid blade = spinning_blade(25);
  for (const double exposure_s : {0.0, 0.002}) {
    Sight sight = looking_north(lens);
    sight.shutter = {exposure_s, 0.02, Readout::kDown};
    // At each moment of the readout, the tips whose rows are exposed then.
    constexpr double kRowS = 0.02 / kSize.height;
    BoxBounds expected;
    for (double t = -0.011; t < 0.011; t += 1e-6)
      for (const double radius_px : {-100.0, 100.0}) {
        const double angle = 2 * kPi * 25 * t;
        const Pixel at(640 + radius_px * std::sin(angle), 480 - radius_px * std::cos(angle));
        const double row_s = (at.y() / kSize.height - 0.5) * 0.02;
        if (std::abs(t - row_s) <= 0.5 * (exposure_s + kRowS)) expected.add(at);
      }
    expect_box(blade.seen(sight, at(4.8, 0, 0)).box, *expected.box(), 0.4);
  }
}

}  // namespace
}  // namespace airtruth::projection
