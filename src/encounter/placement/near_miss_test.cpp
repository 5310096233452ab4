// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "encounter/passage/passage.h"
#include "encounter/placement/by_approach.h"
#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "foundation/geometry/units.h"

namespace airtruth::placement {
namespace {

using trajectory::Path;

Path flying_north(double speed_mps) {
  return trajectory::uniform({0, 0, -150}, {speed_mps, 0, 0}, {});
}

// The path goes through the place, as fast as stated, and passes at the distance and the height.
void expect_near_miss(const NearMiss& wanted, const Path& own) {
  const Path path = path_to_approach(encounter_of(wanted, own), own);
  const auto there = path.at(wanted.time_s);
  ASSERT_TRUE(there);
  EXPECT_NEAR((there->position_in_world - wanted.place_ned_m).norm(), 0, 1e-6);
  EXPECT_NEAR(there->velocity_in_world_mps.norm(), wanted.speed_mps, 1e-9);
  if (!wanted.above_m) {
    EXPECT_NEAR(there->velocity_in_world_mps.z(), 0, 1e-9);
  }
  const auto closest = passage::closest_approach(own, path, wanted.time_s - 1, wanted.time_s + 200);
  ASSERT_TRUE(closest);
  EXPECT_NEAR(closest->distance_m, wanted.miss_m, 2 * kMissM);
  if (wanted.above_m) {
    EXPECT_NEAR(closest->offset.above_m, *wanted.above_m, 2 * kMissM);
  }
  EXPECT_EQ(closest->offset.right_m > 0, wanted.is_right);
}

// 400 m straight ahead, closing at 100 m/s: the tangent's angle has a sine of 100 / 400.
TEST(NearMiss, IsATangentOfTheCircleOfTheMissDistance) {
  const NearMiss wanted{
      .place_ned_m = {400, 0, -150}, .time_s = 2, .miss_m = 100, .is_right = true, .speed_mps = 60};
  const Path own = trajectory::uniform({0, 0, -150}, {0, 0, 0}, {});
  const scene::Encounter encounter = encounter_of(wanted, own);
  EXPECT_NEAR(encounter.cpa_time_s, 2 + 400 * std::sqrt(1 - 1.0 / 16) / 60, 1e-9);
  EXPECT_NEAR(encounter.cpa_above_m, 0, 1e-9);
  EXPECT_NEAR(encounter.speed_mps, 60, 1e-9);
  EXPECT_NEAR(std::abs(encounter.course_deg), 180 - degrees(std::asin(0.25)), 1e-9);
  EXPECT_NEAR(encounter.cpa_right_m.value(), 100 * std::sqrt(1 - 1.0 / 16), 1e-9);
}

TEST(NearMiss, GoesThroughThePlaceAndPasses) {
  Random random(7);
  for (int k = 0; k < 200; ++k) {
    const double bearing_rad = random.uniform(-1.1, 1.1);
    const double range_m = random.uniform(200, 3000);
    const double own_mps = random.uniform(5, 80);
    const double above_m = random.uniform(-30, 30);
    const double beside_m = random.uniform(1, 140) * std::cos(bearing_rad);
    NearMiss wanted{.place_ned_m = {range_m * std::cos(bearing_rad),
                                    range_m * std::sin(bearing_rad),
                                    -150 - above_m},
                    .time_s = 0,
                    .miss_m = std::hypot(beside_m, above_m),
                    .is_right = random.uniform(0, 1) < 0.5,
                    .speed_mps = own_mps + random.uniform(30, 200)};
    expect_near_miss(wanted, flying_north(own_mps));
    // From up to 30 m higher or lower to the height that is asked for.
    wanted.above_m = above_m;
    wanted.place_ned_m.z() -= random.uniform(-30, 30);
    expect_near_miss(wanted, flying_north(own_mps));
  }
}

TEST(NearMiss, PassesAnOwnAircraftThatTurns) {
  const Path own = trajectory::steady({.position_ned_m = {0, 0, -150},
                                       .time_s = 0,
                                       .course_deg = 0,
                                       .ground_speed_mps = 25,
                                       .climb_mps = 0.5,
                                       .turn_rate_dps = 3},
                                      {});
  for (const bool is_right : {true, false})
    expect_near_miss(
        {.place_ned_m = {300, 80, -170}, .miss_m = 45, .is_right = is_right, .speed_mps = 50}, own);
}

std::string refused(const NearMiss& wanted) {
  try {
    encounter_of(wanted, flying_north(40));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(NearMiss, SaysWhyThereIsNone) {
  const Vector3 near(90, 0, -150), abeam(0, 400, -150);
  EXPECT_NE(refused({.place_ned_m = near, .miss_m = 100, .speed_mps = 60}).find("is 90 m away"),
            std::string::npos);
  // At the closest approach itself: at the own aircraft, straight above it, and abeam.
  for (const auto& [place, miss_m, away_m] : {std::tuple(Vector3(0, 0, -150), 0.0, 0),
                                              std::tuple(Vector3(0, 0, -180), 30.0, 0),
                                              std::tuple(Vector3(0, 25, -150), 25.0, 25)})
    EXPECT_EQ(refused({.place_ned_m = place, .miss_m = miss_m, .speed_mps = 60}),
              "the intruder is " + std::to_string(away_m) +
                  " m away horizontally at that moment; expected a smaller miss distance or an "
                  "earlier moment");
  EXPECT_NE(refused({.place_ned_m = {400, 0, -190}, .miss_m = 30, .speed_mps = 60})
                .find("passes 40 m above"),
            std::string::npos);
  EXPECT_NE(refused({.place_ned_m = {400, 0, -950}, .miss_m = 30, .speed_mps = 60, .above_m = 0})
                .find("descend"),
            std::string::npos);
  EXPECT_NE(refused({.place_ned_m = abeam, .miss_m = 10, .speed_mps = 30}).find("higher speed"),
            std::string::npos);
}

}  // namespace
}  // namespace airtruth::placement
