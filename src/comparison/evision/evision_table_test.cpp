// SPDX-License-Identifier: Apache-2.0
#include "comparison/evision/evision_table.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"

namespace airtruth::evision {
namespace {

// A camera that has flown s times its height over a plane: a point of the plane y below the horizon
// is now at y / (1 - s y), by similar triangles; and all is then rolled and shifted.
TEST(EvisionMotion, RecoversShiftRollAndDriftFromPoints) {
  const Pixel centre(640, 480);
  const double focal = 480;
  const double roll = 0.06;
  const double drift = 0.25;
  std::vector<Sighting> sightings;
  for (const Pixel& still :
       {Pixel(100, 300), Pixel(1100, 350), Pixel(640, 60), Pixel(600, 420), Pixel(900, 150)}) {
    const double x = (still.x() - 640) / focal;
    const double y = (still.y() - 480) / focal;
    const double u = focal * x / (1 - drift * y);
    const double v = focal * y / (1 - drift * y);
    sightings.push_back({still,
                         {640 + std::cos(roll) * u - std::sin(roll) * v + 12,
                          480 + std::sin(roll) * u + std::cos(roll) * v - 30}});
  }
  const Homography h = motion_from_sightings(sightings, centre, focal);
  for (const Sighting& s : sightings)
    EXPECT_NEAR((apply(h, s.still_px) - s.found_px).norm(), 0, 1.0);
}

TEST(EvisionMotion, OneSightingGivesAShiftAndNoneGivesNothing) {
  EXPECT_EQ(motion_from_sightings({}, {640, 480}, 480), Homography::Identity());
  const Homography h = motion_from_sightings({{{640, 480}, {650, 470}}}, {640, 480}, 480);
  EXPECT_NEAR((apply(h, {640, 480}) - Pixel(650, 470)).norm(), 0, 1e-3);
}

TEST(EvisionTable, AFolderWithoutAnnotationsIsAnErrorThatNamesIt) {
  try {
    evision_table("/nonexistent", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("/nonexistent/groundtruth"));
  }
}

}  // namespace
}  // namespace airtruth::evision
