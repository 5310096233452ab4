// SPDX-License-Identifier: Apache-2.0
#include "camera/horizon/horizon.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <gtest/gtest.h>

#include "foundation/base/seed.h"
#include "foundation/geometry/horizon_dip.h"

// A horizon is a line that is sharp over the whole width. The tests draw pictures ray by ray from a
// known attitude, and check that a boundary between two colours without such a line is refused.
namespace airtruth::horizon {
namespace {

constexpr int kSkyWidth = 640, kSkyHeight = 480;
constexpr double kFovDeg = 60;

lens::Lens the_lens() { return lens::pinhole_from_vertical_fov(kFovDeg, {kSkyWidth, kSkyHeight}); }

Vector3 up_of(double pitch_deg, double roll_deg) {
  const Quaternion world_from_camera_body = world_from_body({0, pitch_deg, roll_deg});
  return cam_from_body() * (world_from_camera_body.conjugate() * Vector3(0, 0, -1));
}

// The colour of a direction, by its azimuth and elevation above the level in degrees.
struct Paint {
  double luma, cb, cr;
};
using Scene = std::function<Paint(double azimuth_deg, double elevation_deg)>;
const Paint kSky{190, 142, 116};
const Paint kGround{90, 112, 126};

Paint mixed(const Paint& low, const Paint& high, double share) {
  return {low.luma + share * (high.luma - low.luma),
          low.cb + share * (high.cb - low.cb),
          low.cr + share * (high.cr - low.cr)};
}

image::Picture drawn(double pitch_deg, double roll_deg, double noise_codes, const Scene& scene) {
  const lens::Lens lens = the_lens();
  const Quaternion level_from_cam = cam_from_level(up_of(pitch_deg, roll_deg)).conjugate();
  image::Picture picture = image::make_picture(kSkyWidth, kSkyHeight, image::Colour{});
  Random random(7);
  for (int y = 0; y < kSkyHeight; ++y)
    for (int x = 0; x < kSkyWidth; ++x) {
      const Vector3 ray = level_from_cam * *lens.ray_from_pixel({x + 0.5, y + 0.5});
      const Paint paint =
          scene(degrees(std::atan2(ray.y(), ray.x())), degrees(std::asin(-ray.z())));
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(
          std::clamp(std::round(paint.luma + noise_codes * random.normal()), 16.0, 235.0));
      picture.planes[1].row(y / 2)[x / 2] = static_cast<std::uint8_t>(std::lround(paint.cb));
      picture.planes[2].row(y / 2)[x / 2] = static_cast<std::uint8_t>(std::lround(paint.cr));
    }
  return picture;
}

bool is_refused(const image::Picture& picture) {
  const auto found = HorizonFinder(the_lens(), nullptr).find(picture);
  return !found || !found->is_sharp();
}

// Fields: squares of a few degrees that differ by 30 code values.
double field(double azimuth_deg, double elevation_deg) {
  const auto index = static_cast<int>(std::floor(azimuth_deg / 4) + 3 * std::floor(elevation_deg));
  return 10 * (((index % 4) + 4) % 4);
}

TEST(Horizon, ASharpLineIsFoundWithItsRollAndItsPlace) {
  const HorizonFinder finder(the_lens(), nullptr);
  for (const auto& [pitch_deg, roll_deg] :
       {std::pair(5.0, 0.0), std::pair(-3.0, 12.0), std::pair(2.0, -35.0)}) {
    const image::Picture picture =
        drawn(pitch_deg, roll_deg, 2, [](double azimuth_deg, double elevation_deg) {
          if (elevation_deg > 0) return kSky;
          Paint paint = kGround;
          paint.luma += field(azimuth_deg, elevation_deg);
          return paint;
        });
    const auto found = finder.find(picture);
    ASSERT_TRUE(found && found->is_sharp()) << roll_deg;
    EXPECT_GT(found->sharpness, 0.95);
    const YawPitchRoll attitude = attitude_from_up(found->up_in_cam);
    EXPECT_NEAR(attitude.roll_deg, roll_deg, 0.15);
    EXPECT_NEAR(attitude.pitch_deg, pitch_deg, 0.15);
    // A level line crosses the middle column of a camera that is pitched up by 5 degrees at 240 +
    // 240 / tan(30 deg) tan(5 deg) = 276.4 px.
    if (roll_deg == 0) {
      const Vector3& up = found->up_in_cam;
      const double y_px = 240 - 240 / std::tan(radians(30)) * up.z() / up.y();
      EXPECT_NEAR(y_px, 276.4, 1.0);
    }
    // A search that starts one degree beside it finds the same line.
    const auto followed = finder.follow(picture, up_of(pitch_deg + 0.7, roll_deg - 0.5));
    EXPECT_TRUE(followed.is_sharp());
    EXPECT_LT(degrees(std::acos(std::min(1.0, followed.up_in_cam.dot(found->up_in_cam)))), 0.15);
  }
}

// From 1000 m the sky ends 1.015 degrees below the horizontal, all around.
TEST(Horizon, ThatIsSeenLiesBelowTheHorizontalByItsDip) {
  const double dip_rad = horizon_dip_rad(1000);
  EXPECT_NEAR(degrees(dip_rad), 1.015, 1e-3);
  EXPECT_EQ(horizon_dip_rad(-5), 0);
  for (const auto& [pitch_deg, roll_deg] :
       {std::pair(5.0, 0.0), std::pair(-6.0, 25.0), std::pair(2.0, -50.0)}) {
    const image::Picture picture =
        drawn(pitch_deg, roll_deg, 2, [&](double azimuth_deg, double elevation_deg) {
          if (elevation_deg > -degrees(dip_rad)) return kSky;
          Paint paint = kGround;
          paint.luma += field(azimuth_deg, elevation_deg);
          return paint;
        });
    const auto found = HorizonFinder(the_lens(), nullptr).find(picture);
    ASSERT_TRUE(found && found->is_sharp()) << roll_deg;
    const YawPitchRoll attitude = attitude_from_up(up_from_seen(found->up_in_cam, dip_rad));
    EXPECT_NEAR(attitude.roll_deg, roll_deg, 0.2);
    EXPECT_NEAR(attitude.pitch_deg, pitch_deg, 0.2);
    const Vector3 up = up_of(pitch_deg, roll_deg);
    EXPECT_TRUE(up_from_seen(seen_from_up(up, dip_rad), dip_rad).isApprox(up, 1e-12));
  }
  // A camera that looks straight down has no horizon ahead.
  const Vector3 down(0, 0, -1);
  EXPECT_EQ(up_from_seen(down, dip_rad), down);
}

// Red alone steps at the horizon; green has none.
TEST(Horizon, OfRedGreenAndBlueItIsThatOfTheirLuma) {
  image::Picture red = drawn(5, 10, 2, [](double azimuth_deg, double elevation_deg) {
    Paint paint = elevation_deg > 0 ? kSky : kGround;
    if (elevation_deg <= 0) paint.luma += field(azimuth_deg, elevation_deg);
    return paint;
  });
  image::Picture picture = image::make_picture(
      kSkyWidth, kSkyHeight, {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  Random random(8);
  for (const std::size_t p : {0U, 1U})
    for (int y = 0; y < kSkyHeight; ++y)
      for (int x = 0; x < kSkyWidth; ++x)
        picture.planes[p].row(y)[x] =
            static_cast<std::uint8_t>(std::lround(120 + 2 * random.normal()));
  picture.planes[2] = std::move(red.planes[0]);
  const auto found = HorizonFinder(the_lens(), nullptr).find(picture);
  ASSERT_TRUE(found && found->is_sharp());
  EXPECT_NEAR(attitude_from_up(found->up_in_cam).roll_deg, 10, 0.3);
  EXPECT_NEAR(attitude_from_up(found->up_in_cam).pitch_deg, 5, 0.3);
}

// Hills of half a degree and haze that halves the step leave a detectable horizon.
TEST(Horizon, LowHillsInHazeAreAHorizonStill) {
  const image::Picture picture = drawn(4, 8, 2, [](double azimuth_deg, double elevation_deg) {
    const double hills_deg = 0.25 + 0.25 * std::sin(azimuth_deg / 3);
    if (elevation_deg > hills_deg) return kSky;
    const double haze = 0.6 * std::exp((elevation_deg - hills_deg) / 4);
    return mixed(kGround, kSky, haze);
  });
  const auto found = HorizonFinder(the_lens(), nullptr).find(picture);
  ASSERT_TRUE(found && found->is_sharp());
  EXPECT_NEAR(attitude_from_up(found->up_in_cam).roll_deg, 8, 0.7);
  EXPECT_NEAR(attitude_from_up(found->up_in_cam).pitch_deg, 4, 0.7);
}

// A sky that brightens downwards, or ground that fades into the sky over some degrees, has a slope
// but no edge.
TEST(Horizon, ABroadGradientIsRefused) {
  for (const double width_deg : {70.0, 40.0, 24.0}) {
    EXPECT_TRUE(is_refused(drawn(3, 10, 1, [&](double, double elevation_deg) {
      const double place = std::clamp(elevation_deg / width_deg, -0.5, 0.5);
      return mixed(kGround, kSky, 0.5 + 0.5 * std::sin(kPi * place));
    }))) << width_deg;
    EXPECT_TRUE(is_refused(drawn(0, 0, 0, [&](double, double elevation_deg) {
      return mixed(kGround, kSky, std::clamp(0.5 + elevation_deg / width_deg, 0.0, 1.0));
    }))) << width_deg;
  }
}

// A coast: on one side a level sea under haze of nearly its colour, on the other land with houses,
// whose skyline rises to that side.
Paint coast(double azimuth_deg, double elevation_deg, double slope, double side) {
  const Paint sea{150, 136, 120}, haze{175, 134, 122};
  const double inland_deg = side * azimuth_deg + 4;
  const bool house = (static_cast<int>(std::floor(azimuth_deg / 1.7)) & 3) == 1;
  const double skyline_deg = slope * inland_deg + (house ? 1.5 : 0);
  if (inland_deg > 0 && elevation_deg < skyline_deg && elevation_deg > -2 * inland_deg) {
    Paint land = kGround;
    land.luma += field(azimuth_deg, 3 * elevation_deg);
    return land;
  }
  if (elevation_deg < 0) return sea;
  return mixed(haze, kSky, std::min(1.0, elevation_deg / 15));
}

// The plane that separates the colours of a coast is neither the sea's horizon nor the skyline.
TEST(Horizon, ACoastIsRefused) {
  for (const double slope : {0.2, 0.3, 0.4})
    for (const double side : {-1.0, 1.0}) {
      const image::Picture picture = drawn(0, 0, 1, [&](double azimuth_deg, double elevation_deg) {
        return coast(azimuth_deg, elevation_deg, slope, side);
      });
      EXPECT_TRUE(is_refused(picture)) << slope << ' ' << side;
    }
}

// Where the land is lower than the sea's horizon, the detected line is the sea's, which is level.
TEST(Horizon, OfALowCoastTheSeaIsFound) {
  const image::Picture picture = drawn(0, 0, 1, [](double azimuth_deg, double elevation_deg) {
    return coast(azimuth_deg, elevation_deg, 0.12, 1);
  });
  const auto found = HorizonFinder(the_lens(), nullptr).find(picture);
  ASSERT_TRUE(found && found->is_sharp());
  EXPECT_NEAR(attitude_from_up(found->up_in_cam).roll_deg, 0, 1);
}

// A tilted bank of clouds, either soft over six degrees or sharp in tufts of two degrees.
TEST(Horizon, ATiltedBankOfCloudsIsRefused) {
  const Paint cloud{215, 128, 128}, blue{140, 150, 110};
  EXPECT_TRUE(is_refused(drawn(2, 20, 1, [&](double, double elevation_deg) {
    return mixed(cloud, blue, 1 / (1 + std::exp(-elevation_deg / 1.5)));
  })));
  EXPECT_TRUE(is_refused(drawn(2, 20, 1, [&](double azimuth_deg, double elevation_deg) {
    return elevation_deg < 2.5 * std::abs(std::sin(azimuth_deg / 2.3)) ? cloud : blue;
  })));
}

// Against the share of 64 x 64 rays of the pixel.
TEST(Horizon, AShareOfAPixelIsThatOfItsRays) {
  int crossed = 0;
  for (const lens::Lens& lens :
       {the_lens(), lens::fisheye_from_vertical_fov(140, {kSkyWidth, kSkyHeight})})
    for (const auto& [pitch, roll] : {std::pair(0.02, 0.0), {3, 7}, {-4, 45}, {2, 90}, {1, -160}}) {
      const Vector3 up = up_of(pitch, roll);
      for (int y = 0; y < kSkyHeight; y += 3)
        for (int x = 0; x < kSkyWidth; x += 7) {
          const float share = share_below(lens, up, Homography::Identity(), x, y);
          const double middle = lens.ray_from_pixel({x + 0.5, y + 0.5})->dot(up);
          if (std::abs(middle) > 0.01) {
            ASSERT_EQ(share, middle < 0 ? 1.0F : 0.0F) << x << ' ' << y;
            continue;
          }
          int below = 0;
          for (int k = 0; k < 64 * 64; ++k)
            below +=
                lens.ray_from_pixel({x + (k % 64 + 0.5) / 64, y + (k / 64 + 0.5) / 64})->dot(up) < 0
                    ? 1
                    : 0;
          EXPECT_NEAR(share, below / 4096.0, 0.012) << x << ' ' << y << ' ' << roll;
          crossed += share > 0 && share < 1 ? 1 : 0;
        }
    }
  EXPECT_GT(crossed, 300);
  // The row y = 240 of a level camera is the horizon; a picture moved by 10.25 px moves it along.
  Homography nominal_from_frame = Homography::Identity();
  nominal_from_frame(1, 2) = -10.25;
  EXPECT_NEAR(share_below(the_lens(), up_of(0, 0), nominal_from_frame, 99, 250), 0.75, 1e-4);
  // A pixel whose two rays, of its middle and of its right edge, are equally far from the lens's
  // middle column: the horizon is along the rows to the last bit.
  nominal_from_frame(0, 2) = 0.25;
  const Vector3 up = -Vector3::UnitY();
  EXPECT_EQ(share_below(the_lens(), up, nominal_from_frame, kSkyWidth / 2 - 1, 300), 1);
  EXPECT_EQ(share_below(the_lens(), up, nominal_from_frame, kSkyWidth / 2 - 1, 100), 0);
}

}  // namespace
}  // namespace airtruth::horizon
