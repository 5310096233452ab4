// SPDX-License-Identifier: Apache-2.0
#include "calibration/air/air.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "calibration/air/ground_seen.h"
#include "foundation/base/seed.h"

// Air over ground that no two pictures share, so that only the darkest ground gives the extinction.
namespace airtruth::air {
namespace {

constexpr double kAltitudeM = 120;
constexpr std::array<double, 3> kAirlight{0.5, 0.6, 0.7}, kExtinctionPerKm{0.24, 0.3, 0.36};

// Woods and fields with random light, constant over a square.
double own_light(const Vector3& place_m, std::uint64_t land) {
  constexpr double kSquareM = 80;
  const auto north = static_cast<std::uint64_t>(std::lround(place_m.x() / kSquareM) + 1000);
  const auto east = static_cast<std::uint64_t>(std::lround(place_m.y() / kSquareM) + 1000);
  Random random = Seed(land).stream("land", 100000 * north + east);
  return random.uniform() < 0.5 ? 0.03 : random.uniform(0.08, 0.3);
}

// A picture of the land by a level camera that looks north.
image::Picture hazy_land(const lens::Lens& lens,
                         std::uint64_t land,
                         const std::array<double, 3>& extinction_per_km = kExtinctionPerKm) {
  const auto [width, height] = lens.size();
  const Quaternion world_from_cam = cam_from_body().conjugate();
  image::Picture picture = image::make_picture(
      width, height, {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  constexpr std::array<std::size_t, 3> kPlane{2, 0, 1};  // of red, green, blue
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vector3 direction = world_from_cam * *lens.ray_from_pixel({x + 0.5, y + 0.5});
      const double range_m = direction.z() > 0 ? kAltitudeM / direction.z() : 1e9;
      const double own = range_m < 5e4 ? own_light(range_m * direction, land) : 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double t = std::exp(-extinction_per_km[c] * 1e-3 * range_m);
        const double light = kAirlight[c] + (own - kAirlight[c]) * t;
        picture.planes[kPlane[c]].row(y)[x] = static_cast<std::uint8_t>(
            std::lround(255 * image::ToneCurve{}.coded_from_linear(light)));
      }
    }
  return picture;
}

TEST(AirMeter, TellsExtinctionFromTheDarkestGround) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(50, {640, 480});
  std::vector<image::Picture> pictures;
  AirMeter meter(lens, nullptr, {kAltitudeM, ""}, {});
  AirMeter blind(lens, nullptr, {std::nullopt, "no altitude"}, {});
  for (std::uint64_t land = 0; land < 6; ++land) pictures.push_back(hazy_land(lens, land));
  for (const image::Picture& picture : pictures) {
    meter.add(picture, cam_from_body());
    blind.add(picture, cam_from_body());
  }
  const Air air = meter.air();
  ASSERT_TRUE(air.extinction_per_km) << air.extinction_per_km.why();
  ASSERT_TRUE(air.airlight) << air.airlight.why();
  for (std::size_t c = 0; c < 3; ++c) {
    // The method itself is an eighth too low here.
    EXPECT_NEAR((*air.extinction_per_km)[c].value, kExtinctionPerKm[c], 0.2 * kExtinctionPerKm[c]);
    EXPECT_NEAR((*air.airlight)[c].value, kAirlight[c], 0.05 * kAirlight[c]);
  }
  EXPECT_FALSE(air.visibility_km);  // a prior is for what is not measured
  EXPECT_TRUE(blind.air().airlight);
  EXPECT_FALSE(blind.air().extinction_per_km);
}

// The visibility is never less than the true one, whether the height is known or assumed too high.
// Thick haze is distinguished from clear air.
TEST(AirMeter, TheHorizonsLookBoundsTheVisibilityFromBelow) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(50, {640, 480});
  for (const double per_km : {0.05, 0.1, 0.2, 0.3, 0.5}) {
    std::vector<image::Picture> pictures;
    AirMeter blind(lens, nullptr, {std::nullopt, "no altitude"}, {});
    std::vector<SeenLight> sky;
    for (std::uint64_t land = 0; land < 4; ++land)
      pictures.push_back(hazy_land(lens, land, {per_km, per_km, per_km}));
    std::vector<GroundView> views;
    for (const image::Picture& picture : pictures) {
      blind.add(picture, cam_from_body());
      views.push_back({&picture, cam_from_body()});
      const image::ColourCode code(picture.colour);
      for (int y = 0; y < 240; y += 4)
        for (int x = 0; x < 640; x += 4)
          sky.push_back(
              seen_under(cam_from_body().conjugate() * *lens.ray_from_pixel({x + 0.5, y + 0.5}),
                         image::linear_at(picture, code, x, y, {})));
    }
    const auto here = visibility_by_horizon_km(
        ground_patches({views, lens}, kAltitudeM, {}), sky_curves(sky), kAltitudeM);
    ASSERT_TRUE(here);
    std::printf(
        "%.2f per km, seen %.1f km: class of %.0f km\n", per_km, kKoschmieder / per_km, *here);
    EXPECT_GE(*here, std::min(50.0, kKoschmieder / per_km));
    EXPECT_LE(*here, std::max(10.0, 4 * kKoschmieder / per_km));
    ASSERT_TRUE(blind.air().visibility_km);
    EXPECT_GE(*blind.air().visibility_km, *here);
  }
}

}  // namespace
}  // namespace airtruth::air
