// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/sky.h"

#include <gtest/gtest.h>

#include "foundation/geometry/transform.h"

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

// Moon and Spencer: two thirds at 30 degrees; over pi, 7/9 of the zenith on a level surface.
TEST(Sky, AnOvercastSkyIsThatOfMoonAndSpencer) {
  const Skies all = skies(unit_vector(0, 45));
  EXPECT_NEAR(all.overcast_seen(unit_vector(0, 30)) * all.overcast_level, 2.0 / 3, 1e-12);
  EXPECT_NEAR(all.overcast_seen(unit_vector(0, 90)) * all.overcast_level, 1, 1e-12);
  EXPECT_NEAR(all.overcast_level, 7.0 / 9, 1e-3);
  EXPECT_NEAR(all.overcast.irradiance_over_pi(kUp)[0], 1, 0.02);
  // On a wall: 0.396 of the level surface's (Moon and Spencer 1942), without the ground's share.
  EXPECT_NEAR(all.overcast.irradiance_over_pi({1, 0, 0})[1], 0.396, 0.03);
  EXPECT_NEAR(all.overcast.irradiance_over_pi(kDown)[2], 0, 0.03);
}

TEST(Sky, AClearSkyIsBrightAboutTheSunAndAtTheHorizon) {
  const Skies all = skies(unit_vector(90, 40));
  const auto seen = [&](double azimuth_deg, double elevation_deg) {
    return all.clear_seen(unit_vector(azimuth_deg, elevation_deg));
  };
  EXPECT_NEAR(seen(0, 90) * all.clear_level, 1, 1e-12);
  EXPECT_GT(seen(120, 40), seen(180, 40));
  EXPECT_GT(seen(270, 3), seen(270, 60));
  EXPECT_NEAR(all.clear.irradiance_over_pi(kUp)[0], 1, 0.03);
  EXPECT_GT(all.clear.irradiance_over_pi({0, 1, 0})[0],
            all.clear.irradiance_over_pi({0, -1, 0})[0]);
}

TEST(Sky, AGroundLightsWhatLooksDown) {
  const Skies all = skies(unit_vector(0, 30));
  EXPECT_NEAR(all.ground.irradiance_over_pi(kDown)[0], 1, 0.02);
  EXPECT_NEAR(all.ground.irradiance_over_pi(kUp)[0], 0, 0.02);
  EXPECT_NEAR(all.ground.irradiance_over_pi({1, 0, 0})[0], 0.5, 0.02);
}

}  // namespace
}  // namespace airtruth::insertion
