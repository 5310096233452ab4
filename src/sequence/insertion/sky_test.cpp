// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/sky.h"

#include <gtest/gtest.h>

#include "picture/render/renderer.h"

namespace airtruth::insertion {
namespace {

const Eigen::Vector3f kUp(0, 0, -1);
const Eigen::Vector3f kDown(0, 0, 1);

// IES 1984, as tables of daylight give them: 60 degrees, 100.0 klx from the sun and 15.2 from the
// clear sky; 30 degrees, 83.8 and 11.8; overcast at 30 degrees 10.8.
TEST(Sky, IlluminancesAreThoseOfTheTables) {
  EXPECT_NEAR(sun_illuminance_klx(60), 100.0, 0.1);
  EXPECT_NEAR(sun_illuminance_klx(30), 83.8, 0.1);
  EXPECT_NEAR(clear_sky_illuminance_klx(60), 15.2, 0.1);
  EXPECT_NEAR(clear_sky_illuminance_klx(30), 11.8, 0.1);
  EXPECT_EQ(sun_illuminance_klx(-5), sun_illuminance_klx(1));
}

// Moon and Spencer: a third at the horizon; over pi, 7/9 of the zenith on a level surface.
TEST(Sky, AnOvercastSkyIsThatOfMoonAndSpencer) {
  EXPECT_DOUBLE_EQ(overcast_over_zenith(0), 1.0 / 3);
  EXPECT_DOUBLE_EQ(overcast_over_zenith(90), 1);
  const Skies all = skies(shade::to_sun(0, 45));
  EXPECT_NEAR(all.overcast.irradiance_over_pi(kUp)[0], 1, 0.02);
  // On a wall: 0.396 of the level surface's (Moon and Spencer 1942), without the ground's share.
  EXPECT_NEAR(all.overcast.irradiance_over_pi({1, 0, 0})[1], 0.396, 0.03);
  EXPECT_NEAR(all.overcast.irradiance_over_pi(kDown)[2], 0, 0.03);
}

TEST(Sky, AClearSkyIsBrightAboutTheSunAndAtTheHorizon) {
  EXPECT_DOUBLE_EQ(clear_sky_over_zenith(90, 50, 40), 1);
  EXPECT_GT(clear_sky_over_zenith(40, 5, 40), clear_sky_over_zenith(40, 60, 40));
  EXPECT_GT(clear_sky_over_zenith(3, 120, 40), clear_sky_over_zenith(60, 120, 40));
  const Skies all = skies(shade::to_sun(90, 40));
  EXPECT_NEAR(all.clear.irradiance_over_pi(kUp)[0], 1, 0.03);
  EXPECT_GT(all.clear.irradiance_over_pi({0, 1, 0})[0],
            all.clear.irradiance_over_pi({0, -1, 0})[0]);
}

TEST(Sky, AGroundLightsWhatLooksDown) {
  const Skies all = skies(shade::to_sun(0, 30));
  EXPECT_NEAR(all.ground.irradiance_over_pi(kDown)[0], 1, 0.02);
  EXPECT_NEAR(all.ground.irradiance_over_pi(kUp)[0], 0, 0.02);
  EXPECT_NEAR(all.ground.irradiance_over_pi({1, 0, 0})[0], 0.5, 0.02);
}

}  // namespace
}  // namespace airtruth::insertion
