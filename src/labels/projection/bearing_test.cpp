// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "labels/projection/exact_box.h"

namespace airtruth::projection {
namespace {

constexpr lens::ImageSize kBearingSize{1280, 960};
const lens::Pinhole kPinhole{{480, 480}, {640, 480}};

// A camera that looks north: x_cam is east, y_cam is down, z_cam is north.
Sight cam_looking_north(const lens::Lens& lens) {
  return {&lens, Rigid{cam_from_body(), Vector3::Zero()}, Homography::Identity()};
}

Vector3 direction_of(const Bearing& bearing) {
  return cam_from_body() * unit_vector(bearing.azimuth_deg, bearing.elevation_deg);
}

// Computed by hand from 3-4-5 triangles.
TEST(Bearing, IsRightAndUpFromTheAxis) {
  const Bearing right = bearing_of({3, 0, 4});
  EXPECT_NEAR(right.azimuth_deg, 36.86989764584402, 1e-12);
  EXPECT_NEAR(right.elevation_deg, 0, 1e-12);
  const Bearing up = bearing_of({0, -3, 4});
  EXPECT_NEAR(up.azimuth_deg, 0, 1e-12);
  EXPECT_NEAR(up.elevation_deg, 36.86989764584402, 1e-12);
  EXPECT_NEAR(bearing_of({0, 0, -1}).azimuth_deg, 180, 1e-12);
  for (const Vector3& v : {Vector3(1, 2, 3), Vector3(-5, 1, -2), Vector3(0.1, -7, 2)})
    EXPECT_NEAR((direction_of(bearing_of(v)) - v.normalized()).norm(), 0, 1e-12);
}

// A homography that moves the picture 48 px to the right moves a point straight ahead to a bearing
// of atan(0.1), wherever the nominal boresight points.
TEST(Bearing, OfAPictureThatMovedIsTheRayOfThePixel) {
  const lens::Lens lens(kPinhole, kBearingSize);
  Sight sight = cam_looking_north(lens);
  sight.frame_from_nominal(0, 2) = 48;
  const auto seen = seen_bearing(sight, {1000, 0, 0}, Vector3::Zero());
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->azimuth_deg, 5.710593137499643, 1e-9);
  EXPECT_NEAR(seen->elevation_deg, 0, 1e-9);
  EXPECT_FALSE(seen_bearing(sight, {-1000, 0, 0}, Vector3::Zero()));
}

// Without a homography the bearing needs no pixel, so it also exists behind the camera.
TEST(Bearing, OfATurnedCameraIsItsOwn) {
  const lens::Lens lens(kPinhole, kBearingSize);
  Sight sight = cam_looking_north(lens);
  // The camera yaws right by 10 degrees, so north lies 10 degrees to its left.
  sight.cam_from_world.rotation =
      rotation_from_vector(Vector3(0, radians(-10), 0)) * sight.cam_from_world.rotation;
  EXPECT_NEAR(seen_bearing(sight, {500, 0, 0}, Vector3::Zero())->azimuth_deg, -10, 1e-9);
  EXPECT_NEAR(seen_bearing(sight, {-500, 0, 0}, Vector3::Zero())->azimuth_deg, 170, 1e-9);
}

// The camera yaws right at 1 rad/s and is read out downwards in 20 ms. The lowest row is exposed 10
// ms after the middle row, when the camera has turned 0.01 rad further.
TEST(Bearing, WithARollingShutterIsOfThePointsOwnRow) {
  const lens::Lens lens(kPinhole, kBearingSize);
  Sight sight = cam_looking_north(lens);
  sight.shutter = {0, 0.02, Readout::kDown};
  // About the axis that points down.
  sight.camera.rate_radps = {0, 0, 1};
  // On the centre line of the lowest row.
  const double down = 1000 * 479.5 / 480;
  const auto seen = seen_bearing(sight, {1000, 0, down}, Vector3::Zero());
  const double dt_s = sight.shutter.middle_s({640, 959.5}, 1280, 960);
  EXPECT_NEAR(dt_s, 0.01, 1e-4);
  EXPECT_NEAR(radians(seen->azimuth_deg), -dt_s, 2e-5);
  // The ray belongs to the pixel that shows the point at that time.
  const auto pixel = lens.pixel_from_cam(direction_of(*seen));
  const auto drawn = pixel_from_world(sight.at(dt_s), {1000, 0, down});
  EXPECT_NEAR((*pixel - *drawn).norm(), 0, 0.05);
  // An aircraft that flies east at 100 m/s, 1 km away, moves by 1 mrad during that time.
  const auto moving = seen_bearing(sight, {1000, 0, down}, {0, 100, 0});
  EXPECT_NEAR(radians(moving->azimuth_deg - seen->azimuth_deg), 1e-3, 2e-5);
}

}  // namespace
}  // namespace airtruth::projection
