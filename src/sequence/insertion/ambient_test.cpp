// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/ambient.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "foundation/geometry/transform.h"
#include "foundation/image/colour.h"

namespace airtruth::insertion {
namespace {

constexpr int kSkySize = 120;
constexpr image::Rgb kSkyColour = {0.55F, 0.85F, 1.6F};
constexpr float kSkyLevel = 0.2F;  // irradiance over pi on a level surface

std::uint8_t to_code(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

// A picture of linear light by pixel, clipped at 1.
template <typename LightAt>
image::Picture picture_of(const LightAt& light_at) {
  image::Colour colour;
  colour.chroma = image::Chroma::k444;
  image::Picture picture = image::make_picture(kSkySize, kSkySize, colour);
  const image::ColourCode code(colour);
  for (int y = 0; y < kSkySize; ++y)
    for (int x = 0; x < kSkySize; ++x) {
      image::Rgb coded = light_at(x, y);
      for (float& value : coded)
        value = static_cast<float>(image::ToneCurve{}.coded_from_linear(std::min(1.0F, value)));
      const image::Ycc ycc = code.ycc_from_rgb(coded);
      picture.planes[0].row(y)[x] = to_code(ycc.y);
      picture.planes[1].row(y)[x] = to_code(ycc.cb);
      picture.planes[2].row(y)[x] = to_code(ycc.cr);
    }
  return picture;
}

// A clear sky of a known level under a sun, as a camera of that pitch sees it.
struct ClearSky {
  lens::Lens lens{lens::Pinhole{{100, 100}, {kSkySize / 2.0, kSkySize / 2.0}},
                  {kSkySize, kSkySize}};
  projection::Sight sight;
  scene::Light light;
  image::Picture picture;

  ClearSky(double pitch_deg, double sun_azimuth_deg, double sun_elevation_deg) {
    const Quaternion world_from_cam =
        world_from_body({0, pitch_deg, 0}) * cam_from_body().conjugate();
    sight = {&lens, Rigid{world_from_cam, Vector3::Zero()}.inverse(), Homography::Identity()};
    light.sun_azimuth_deg = sun_azimuth_deg;
    light.sun_elevation_deg = sun_elevation_deg;
    const Skies all = skies(unit_vector(sun_azimuth_deg, sun_elevation_deg));
    picture = picture_of([&](int x, int y) {
      const auto ray = lens.ray_from_pixel({x + 0.5, y + 0.5});
      const auto seen = static_cast<float>(all.clear_seen(world_from_cam * ray->normalized()));
      image::Rgb light;
      for (std::size_t c = 0; c < 3; ++c) light[c] = kSkyLevel * seen * kSkyColour[c];
      return light;
    });
  }

  Ambient seen() const { return AmbientEstimator(light, {}, nullptr).next(picture, sight, {}); }
};

// The result does not depend on the part of the sky in view: low or high, towards the sun or away
// from it.
TEST(Ambient, AClearSkysLightIsThatOfTheWholeSkyWhereverTheCameraLooks) {
  for (const double pitch_deg : {25.0, 50.0})
    for (const double azimuth_deg : {100.0, 180.0}) {
      const Ambient light = ClearSky(pitch_deg, azimuth_deg, 40).seen();
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(light.blue[c], kSkyLevel * kSkyColour[c], 0.03F * kSkyLevel * kSkyColour[c])
            << pitch_deg << " " << azimuth_deg << " " << c;
        EXPECT_NEAR(light.cloud[c], 0, 1e-3F);
      }
    }
}

// Whether its light is stated or measured.
TEST(Ambient, ASunThatHasSetLightsNothing) {
  for (const bool is_stated : {false, true}) {
    const auto sun_at = [&](double elevation_deg) {
      ClearSky sky(25, 100, elevation_deg);
      if (is_stated) sky.light.exposure = 0.5;
      return sky.seen().sun[0];
    };
    EXPECT_GT(sun_at(0), 0);
    EXPECT_EQ(sun_at(-1), 0);
    EXPECT_EQ(sun_at(-90), 0);
  }
}

TEST(Ambient, ABlackPictureGetsTheLightOfAnOvercastSky) {
  ClearSky black(40, 180, 30);
  EXPECT_FALSE(black.seen().is_assumed);
  for (std::size_t plane = 0; plane < 3; ++plane)
    for (int y = 0; y < kSkySize; ++y)
      std::fill_n(
          black.picture.planes[plane].row(y), kSkySize, std::uint8_t(plane == 0 ? 16 : 128));
  const Ambient light = black.seen();
  EXPECT_TRUE(light.is_assumed);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_FLOAT_EQ(light.sky()[c], 0.5F);
    EXPECT_FLOAT_EQ(light.airlight[c], 0);
  }
}

TEST(Ambient, AGroundThatIsNotSeenGivesBackItsShareOfSunAndSky) {
  ClearSky sky(40, 180, 30);
  const Ambient usual = sky.seen();
  sky.light.ground_albedo = 0.7;
  const Ambient snow = sky.seen();
  image::Rgb albedo{};
  for (std::size_t c = 0; c < 3; ++c) {
    const float level = 0.5F * usual.sun[c] + usual.sky()[c];  // the sine of 30 degrees
    albedo[c] = usual.ground[c] / level;
    EXPECT_NEAR(snow.ground[c], 0.7F * level, 1e-4F);
  }
  // A warm grey, where snow is white.
  EXPECT_NEAR(0.2126F * albedo[0] + 0.7152F * albedo[1] + 0.0722F * albedo[2], 0.1F, 1e-3F);
  EXPECT_NEAR(albedo[0] / albedo[1], 1.14F, 0.01F);
  EXPECT_NEAR(albedo[2] / albedo[1], 0.78F, 0.01F);
}

// A sky of two even halves.
image::Picture sky_of(const image::Rgb& left, const image::Rgb& right) {
  return picture_of([&](int x, int) { return x < kSkySize / 2 ? left : right; });
}

Ambient light_of(const image::Rgb& left, const image::Rgb& right) {
  const ClearSky clear(35, 180, 40);
  return AmbientEstimator(clear.light, {}, nullptr).next(sky_of(left, right), clear.sight, {});
}

// An overcast sky of 7000 K under a white balance for daylight has R/B of 0.7; no sun shines. The
// same blue beside grey clouds is a clear sky, and one of R/B below 0.4 is clear by itself.
TEST(Ambient, ABluishOvercastSkyHasNoSunAndTheSameBlueBesideCloudsHas) {
  const image::Rgb bluish = {0.42F, 0.48F, 0.60F};
  const image::Rgb grey = {0.6F, 0.6F, 0.6F};
  const image::Rgb blue = {0.12F, 0.22F, 0.40F};
  const Ambient overcast = light_of(bluish, bluish);
  EXPECT_LT(overcast.sun[1], 0.15F * bluish[1]);
  EXPECT_LT(overcast.blue[1], 0.05F * overcast.cloud[1]);
  EXPECT_GT(light_of(bluish, grey).sun[1], 2 * bluish[1]);
  EXPECT_GT(light_of(blue, blue).sun[1], 2 * blue[1]);
}

// The light of a grey sky above and a grey ground below, as a camera that looks level sees them.
Ambient light_over_ground(float sky, float ground) {
  const ClearSky level(0, 180, 40);
  const image::Picture picture = picture_of([&](int, int y) {
    const float light = y < kSkySize / 2 ? sky : ground;
    return image::Rgb{light, light, light};
  });
  return AmbientEstimator(level.light, {}, nullptr).next(picture, level.sight, {});
}

TEST(Ambient, AStatedSkyIsOvercast) {
  ClearSky sky(25, 180, 40);
  sky.light.sky_colour = {0.2, 0.4, 0.8};
  sky.light.ground_colour = {0, 0, 0};
  const shade::Environment light = sky.seen().surroundings;
  EXPECT_NEAR(light.irradiance_over_pi({0, 0, -1})[1], 0.4, 0.02);
  for (const float side : {-1.0F, 1.0F}) {
    EXPECT_NEAR(light.irradiance_over_pi({side, 0, 0})[1], 0.4 * 0.396, 0.02);
    EXPECT_NEAR(light.irradiance_over_pi({0, side, 0})[2], 0.8 * 0.396, 0.03);
  }
}

// The air between is seen against the picture, whoever states the light on the aircraft.
TEST(Ambient, HazeFadesToTheBackgroundUnderAStatedLight) {
  ClearSky clear(35, 180, 40);
  clear.light.exposure = 1;
  clear.light.sky_colour = {0.5, 0.6, 0.8};
  clear.light.ground_albedo = 0.1;
  scene::CameraModel hazy;
  hazy.extinction_per_km = {4, 4, 4};
  const image::Rgb grey = {0.3F, 0.3F, 0.3F};
  const Ambient light =
      AmbientEstimator(clear.light, hazy, nullptr).next(sky_of(grey, grey), clear.sight, {});
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(light.airlight[c], grey[c], 0.005F);
  EXPECT_FLOAT_EQ(light.cloud[2], 0.8F);
}

// Four times the exposure clips the sky; the ground, whose light grows as it should, shows it. A
// ground that is darker than its albedo under that sky says nothing against the sky.
TEST(Ambient, AGroundShowsHowMuchBrighterThanWhiteAClippedSkyIs) {
  const Ambient shown = light_over_ground(0.4F, 0.03F);
  const float ground = 0.1F * (shown.sun[1] * std::sin(0.698132F) + shown.cloud[1]);
  const Ambient clipped = light_over_ground(4 * 0.4F, 4 * ground);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(clipped.cloud[c], 4 * shown.cloud[c], 0.1F * shown.cloud[c]);
    EXPECT_NEAR(clipped.sun[c], 4 * shown.sun[c], 0.1F * shown.sun[c]);
  }
  EXPECT_NEAR(light_over_ground(1.6F, 0.02F).cloud[1], shown.cloud[1] / 0.4F, 0.1F);
}

// An even grey sky; code value of its luma.
image::Picture grey_sky(int luma) {
  image::Picture picture = image::make_picture(96, 72, {});
  for (std::size_t p = 0; p < 3; ++p)
    for (int y = 0; y < picture.planes[p].height; ++y)
      std::fill_n(picture.planes[p].row(y),
                  picture.planes[p].width,
                  static_cast<std::uint8_t>(p == 0 ? luma : 128));
  return picture;
}

// Before a cut the sky nearly clips, so its jump cannot be followed as one of exposure: the
// smoothed light stays too bright, and starts anew at a cut.
TEST(Ambient, ACutBeginsTheLightAnew) {
  const lens::Lens lens = lens::pinhole_from_vertical_fov(20, {96, 72});
  projection::Sight sight;
  sight.lens = &lens;
  sight.cam_from_world.rotation = cam_from_body();
  const auto after = [&](bool begins_shot) {
    AmbientEstimator estimator({}, {}, nullptr);
    for (int k = 0; k < 10; ++k) estimator.next(grey_sky(234), sight, {});
    return estimator.next(grey_sky(80), sight, {}, begins_shot).cloud[1];
  };
  AmbientEstimator alone({}, {}, nullptr);
  const float truth = alone.next(grey_sky(80), sight, {}).cloud[1];
  EXPECT_FLOAT_EQ(after(true), truth);
  EXPECT_GT(after(false), 2 * truth);
}

// The second frame shows the same picture turned about: what was low in it is high in the sky.
// After a cut nothing else of the first frame is left.
TEST(Ambient, DirectionsFollowTheFramesHomography) {
  const ClearSky clear(20, 90, 40);
  projection::Sight turned = clear.sight;
  turned.frame_from_nominal << -1, 0, kSkySize, 0, -1, kSkySize, 0, 0, 1;
  const auto alone = [&](const projection::Sight& sight) {
    return AmbientEstimator(clear.light, {}, nullptr).next(clear.picture, sight, {}).blue[1];
  };
  AmbientEstimator estimator(clear.light, {}, nullptr);
  estimator.next(clear.picture, clear.sight, {});
  EXPECT_FLOAT_EQ(estimator.next(clear.picture, turned, {}, true).blue[1], alone(turned));
  EXPECT_GT(std::abs(alone(turned) / alone(clear.sight) - 1), 0.02);
}

}  // namespace
}  // namespace airtruth::insertion
