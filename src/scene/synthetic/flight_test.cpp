// SPDX-License-Identifier: Apache-2.0
#include "scene/synthetic/flight.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "foundation/base/error.h"
#include "support/far_field.h"

namespace airtruth::synthetic {
namespace {

FlightOptions small() {
  FlightOptions options;
  options.width = 320;
  options.height = 240;
  options.frame_count = 40;
  return options;
}

// Level ground under an empty sky, without noise: the horizon is the only distant edge.
FlightOptions bare() {
  FlightOptions options = small();
  options.cloud_cover = 0;
  options.hills_deg = 0;
  options.noise = 0;
  options.own_aircraft = false;
  return options;
}

// Luma at a point in pixel coordinates whose origin is the image's corner.
double luma_at(const image::Picture& picture, const Pixel& p) {
  const double x = p.x() - 0.5;
  const double y = p.y() - 0.5;
  const int ix = static_cast<int>(std::floor(x));
  const int iy = static_cast<int>(std::floor(y));
  const auto at = [&](int i, int j) {
    return static_cast<double>(picture.luma().row(iy + j)[ix + i]);
  };
  const double fx = x - ix;
  const double fy = y - iy;
  return (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) +
         (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy;
}

// The image row whose ray is tangent to the Earth, with roll and pitch together: the sphere's
// centre is R + h below the camera, and the ray passes it at the distance R.
double horizon_row(const Flight& flight, int frame, double column) {
  constexpr double kRadiusM = 6'371'009;
  const trajectory::State camera = flight.camera(frame);
  const Quaternion world_from_cam = camera.world_from_body * cam_from_body().conjugate();
  const Vector3 centre(0, 0, kRadiusM - camera.position_in_world.z());
  double above = 0, below = flight.options().height;
  while (below - above > 1e-3) {
    const double row = 0.5 * (above + below);
    const Vector3 ray = world_from_cam * *flight.lens().ray_from_pixel({column, row});
    const bool meets = ray.z() > 0 && centre.cross(ray.normalized()).norm() < kRadiusM;
    (meets ? below : above) = row;
  }
  return above;
}

// The row where the smooth sky ends: the first kink of luma down the column.
double end_of_sky(const image::Picture& picture, int column) {
  const auto luma = [&](int y) { return int{picture.luma().row(y)[column]}; };
  int y = 40;
  while (y < picture.height - 1 && std::abs(luma(y + 1) - 2 * luma(y) + luma(y - 1)) < 5) ++y;
  return y;
}

TEST(Flight, HorizonLiesWherePitchAndRollPutIt) {
  FlightOptions options = bare();
  options.roll_deg = 12;
  options.shake_deg = 0.8;
  options.altitude_m = 900;
  const Flight flight(options);
  for (const int frame : {0, 7, 21, 39}) {
    const image::Picture picture = flight.frame(frame);
    std::vector<double> beyond;
    for (int column = 10; column < 310; column += 10)
      beyond.push_back(end_of_sky(picture, column) - horizon_row(flight, frame, column + 0.5));
    std::sort(beyond.begin(), beyond.end());
    // The lens's blur and the sharpening spread the edge by up to two rows.
    EXPECT_NEAR(beyond[beyond.size() / 2], -1, 0.8) << frame;
    EXPECT_NEAR(beyond[3], beyond[beyond.size() - 4], 3) << frame;
  }
}

// Mean difference between frame k and frame 0 warped by the homography.
double mean_difference(const image::Picture& first,
                       const image::Picture& later,
                       const Homography& later_from_first) {
  const Homography back = later_from_first.inverse();
  double sum = 0;
  int count = 0;
  for (int y = 4; y < later.height - 4; ++y)
    for (int x = 4; x < later.width - 4; ++x) {
      const Pixel p = apply(back, {x + 0.5, y + 0.5});
      if (p.x() < 2 || p.y() < 2 || p.x() > first.width - 2 || p.y() > first.height - 2) continue;
      sum += std::abs(luma_at(first, p) - later.luma().row(y)[x]);
      ++count;
    }
  return sum / count;
}

TEST(Flight, TheHomographyCarriesTheFirstFrameToAnyOther) {
  FlightOptions options = small();
  options.noise = 0;
  options.own_aircraft = false;
  options.translate = false;
  options.shake_deg = 0.8;
  const Flight flight(options);
  const image::Picture first = flight.frame(0);
  for (const int frame : {3, 18, 39}) {
    const image::Picture later = flight.frame(frame);
    const double with = mean_difference(first, later, frame_from_first(flight, frame));
    const double without = mean_difference(first, later, Homography::Identity());
    EXPECT_LT(with, 2.5) << frame;
    EXPECT_LT(with, 0.5 * without) << frame;
    // A warp that is half a pixel off is worse, so the check detects such an error.
    Homography aside = frame_from_first(flight, frame);
    aside.row(0) += 0.5 * aside.row(2);
    EXPECT_LT(with, mean_difference(first, later, aside)) << frame;
  }
}

TEST(Flight, SameBytesInAnyOrderAndOnAnyNumberOfThreads) {
  FlightOptions options = small();
  options.clutter = 0.2;
  const Flight flight(options);
  const image::Picture late = flight.frame(30);
  const image::Picture early = flight.frame(3);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Flight again(options);
  EXPECT_TRUE(image::identical(early, again.frame(3)));
  EXPECT_TRUE(image::identical(late, again.frame(30)));
  EXPECT_FALSE(image::identical(early, late));
}

TEST(Flight, AnotherSeedMakesAnotherFlight) {
  FlightOptions options = small();
  const Flight one(options);
  options.seed = 2;
  EXPECT_FALSE(image::identical(one.frame(0), Flight(options).frame(0)));
}

TEST(Flight, OwnAircraftStandsStillWhereTheMaskSaysAndNowhereElse) {
  FlightOptions options = small();
  options.noise = 0;
  const Flight flight(options);
  const image::Mask& mask = flight.own_aircraft();
  FlightOptions without_options = options;
  without_options.own_aircraft = false;
  const Flight without(without_options);
  const image::Picture a = flight.frame(0);
  const image::Picture b = flight.frame(25);
  const image::Picture bare_sky = without.frame(0);
  int hidden = 0;
  for (int y = 5; y < options.height - 5; ++y)
    for (int x = 5; x < options.width - 5; ++x) {
      // Edges are soft and sharpening reaches two pixels, so only pixels whose whole neighbourhood
      // is of one kind count.
      bool all_hidden = true;
      bool all_free = true;
      for (int j = -5; j <= 5; ++j)
        for (int i = -5; i <= 5; ++i) (mask.is_free(x + i, y + j) ? all_hidden : all_free) = false;
      if (all_hidden) {
        ++hidden;
        EXPECT_EQ(a.luma().row(y)[x], b.luma().row(y)[x]) << x << " " << y;
      }
      if (all_free) {
        EXPECT_EQ(a.luma().row(y)[x], bare_sky.luma().row(y)[x]) << x << " " << y;
      }
    }
  EXPECT_GT(hidden, options.width * options.height / 40);
  EXPECT_THAT(without.own_aircraft().free, testing::Each(testing::Eq(255)));
}

TEST(Flight, NoiseIsAsStrongAsAsked) {
  FlightOptions options = bare();
  const Flight clean(options);
  options.noise = 1.5;
  const Flight noisy(options);
  const image::Picture a = clean.frame(0);
  const image::Picture b = noisy.frame(0);
  double sum = 0;
  double square = 0;
  double level = 0;
  int count = 0;
  for (int y = 10; y < 90; ++y)
    for (int x = 10; x < 310; ++x) {
      const double d = static_cast<double>(b.luma().row(y)[x]) - a.luma().row(y)[x];
      sum += d;
      square += d * d;
      level += a.luma().row(y)[x];
      ++count;
    }
  // 1.9 - 0.0045 y code values before the blur and sharpening, whose kernel
  // {1.22 * 0.72, 4 of 1.22 * 0.07, 4 of -0.22 / 4} has a root of squares of 0.908; rounding adds
  // 1/12 twice.
  const double before = 1.5 * (1.9 - 0.0045 * level / count);
  const double expected = std::sqrt(0.908 * 0.908 * before * before + 2.0 / 12);
  EXPECT_NEAR(sum / count, 0, 0.1);
  EXPECT_NEAR(std::sqrt(square / count), expected, 0.08 * expected);
}

TEST(Flight, ShakeHasTheStrengthAsked) {
  FlightOptions options = bare();
  options.frame_count = 3000;
  options.shake_deg = 0.4;
  options.width = 64;
  options.height = 48;
  const Flight flight(options);
  double yaw = 0;
  double pitch = 0;
  for (int k = 0; k < options.frame_count; ++k) {
    const Quaternion shake =
        flight.nominal_camera(k).world_from_body.conjugate() * flight.camera(k).world_from_body;
    const YawPitchRoll angles = yaw_pitch_roll(shake);
    yaw += angles.yaw_deg * angles.yaw_deg;
    pitch += angles.pitch_deg * angles.pitch_deg;
  }
  EXPECT_NEAR(std::sqrt(yaw / options.frame_count), 0.4, 0.02);
  EXPECT_NEAR(std::sqrt(pitch / options.frame_count), 0.4, 0.02);
}

TEST(Flight, CameraFliesAtItsSpeedAlongItsHeading) {
  FlightOptions options = bare();
  options.heading_deg = 90;
  options.speed_mps = 30;
  const Flight flight(options);
  const Vector3 way = flight.camera(30).position_in_world - flight.camera(0).position_in_world;
  EXPECT_NEAR((way - Vector3(0, 30, 0)).norm(), 0, 1e-9);
  EXPECT_DOUBLE_EQ(flight.camera(5).position_in_world.z(), -options.altitude_m);
}

TEST(Flight, ClutterMovesItsShareOfTheImage) {
  FlightOptions options = bare();
  options.translate = false;
  const Flight without(options);
  options.clutter = 0.2;
  const Flight with(options);
  const image::Picture a = without.frame(10);
  const image::Picture b = with.frame(10);
  int changed = 0;
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x)
      changed += std::abs(a.luma().row(y)[x] - b.luma().row(y)[x]) > 3;
  const double share = changed / double(options.width * options.height);
  EXPECT_GT(share, 0.10);
  EXPECT_LT(share, 0.25);
}

TEST(Flight, AFisheyeSeesItToo) {
  FlightOptions options = small();
  options.lens = lens::fisheye_from_vertical_fov(150, {320, 240});
  const Flight flight(options);
  const image::Picture picture = flight.frame(0);
  // The sky is bluer than the ground.
  int sky = 0;
  int ground = 0;
  for (int x = 15; x < 145; ++x) {
    sky += picture.planes[1].row(25)[x];
    ground += picture.planes[1].row(85)[x];
  }
  EXPECT_GT(sky, ground);
}

TEST(Flight, OddSizesWork) {
  FlightOptions options = small();
  options.width = 67;
  options.height = 51;
  const image::Picture picture = Flight(options).frame(1);
  EXPECT_EQ(picture.planes[1].width, 34);
  EXPECT_EQ(picture.planes[1].height, 26);
}

TEST(Flight, CsvHasARowForEveryFrame) {
  FlightOptions options = bare();
  options.frame_count = 3;
  options.shake_deg = 0;
  options.roll_deg = 0;
  const std::string csv = csv_from_flight(Flight(options));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  EXPECT_THAT(
      csv, testing::StartsWith("frame,time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg,"));
  EXPECT_THAT(csv, testing::HasSubstr("\n0,0,0,0,-150,0,"));
}

TEST(Flight, NonsenseIsAnErrorThatNamesIt) {
  const auto message = [](auto change) {
    FlightOptions options = small();
    change(options);
    try {
      const Flight flight(options);
    } catch (const Error& error) {
      return error.message();
    }
    return std::string("no error");
  };
  EXPECT_THAT(message([](FlightOptions& o) { o.cloud_cover = 2; }),
              testing::HasSubstr("cloud cover is 2"));
  EXPECT_THAT(message([](FlightOptions& o) { o.frame_rate_hz = 0; }),
              testing::HasSubstr("frame rate is 0"));
  EXPECT_THAT(message([](FlightOptions& o) { o.altitude_m = 1; }),
              testing::HasSubstr("altitude is 1"));
  EXPECT_THAT(message([](FlightOptions& o) {
                o.lens = lens::pinhole_from_vertical_fov(60, {64, 48});
              }),
              testing::HasSubstr("64 x 48"));
  EXPECT_THAT(message([](FlightOptions& o) { o.vertical_fov_deg = 0.01; }),
              testing::HasSubstr("the focal length is 1375099 px; expected up to 150000"));
}

// The whole panorama of this lens takes 125 GB.
TEST(Flight, ALongLensTakesTheMemoryOfWhatItSees) {
  FlightOptions options = bare();
  options.width = 160;
  options.height = 120;
  options.vertical_fov_deg = 0.2;
  options.frame_rate_hz = 4;
  options.frame_count = 24;
  const Flight flight(options);
  int frames_of_sky = 0;
  for (int frame = 0; frame < options.frame_count; ++frame) {
    if (yaw_pitch_roll(flight.camera(frame).world_from_body).pitch_deg < 0.25) continue;
    ++frames_of_sky;
    const image::Picture picture = flight.frame(frame);
    for (int y = 0; y < options.height; ++y)
      for (int x = 0; x < options.width; ++x) ASSERT_GT(picture.luma().row(y)[x], 100);
  }
  EXPECT_GT(frames_of_sky, 3);
}

}  // namespace
}  // namespace airtruth::synthetic
