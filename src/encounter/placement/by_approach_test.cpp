// SPDX-License-Identifier: Apache-2.0
#include "encounter/placement/by_approach.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/seed.h"
#include "foundation/geometry/units.h"
#include "support/error_of.h"

namespace airtruth::placement {
namespace {

using trajectory::Path;

scene::Encounter head_on() {
  scene::Encounter encounter;
  encounter.cpa_time_s = 8;
  encounter.cpa_right_m = 60;
  encounter.cpa_above_m = 15;
  encounter.course_deg = 180;
  encounter.speed_mps = 62;
  encounter.where = {"s.toml", 9, 1};
  return encounter;
}

Path northward(double speed_mps) {
  return trajectory::uniform({0, 0, -150}, {speed_mps, 0, 0}, {});
}

Vector3 offset_at(const Path& path, const Path& own, double time_s) {
  return path.at(time_s)->position_in_world - own.at(time_s)->position_in_world;
}

// The least distance over a time, found by walking and then by narrowing around the least step.
struct Nearest {
  double time_s = 0;
  double distance_m = 0;
};
Nearest nearest(const Path& path, const Path& own, double begin_s, double end_s) {
  constexpr int kSteps = 4000;
  Nearest best{begin_s, 1e300};
  for (int round = 0; round < 4; ++round) {
    const double step_s = (end_s - begin_s) / kSteps;
    for (int i = 0; i <= kSteps; ++i) {
      const double t = begin_s + step_s * i;
      const double distance_m = offset_at(path, own, t).norm();
      if (distance_m < best.distance_m) best = {t, distance_m};
    }
    begin_s = best.time_s - 2 * step_s;
    end_s = best.time_s + 2 * step_s;
  }
  return best;
}

TEST(ByApproach, HeadOnSixtyMetresToTheRight) {
  const Path own = northward(40);
  const Path path = path_to_approach(head_on(), own);
  const Vector3 offset = offset_at(path, own, 8);
  EXPECT_NEAR(offset.x(), 0, 1e-9);
  EXPECT_NEAR(offset.y(), 60, 1e-9);
  EXPECT_NEAR(offset.z(), -15, 1e-9);
  EXPECT_NEAR(path.at(0)->position_in_world.x(), 8 * 40 + 8 * 62, 1e-9);
  const Vector3 velocity = path.at(3)->velocity_in_world_mps;
  EXPECT_NEAR(velocity.x(), -62, 1e-9);
  EXPECT_NEAR(velocity.y(), 0, 1e-9);
  EXPECT_NEAR(std::abs(yaw_pitch_roll(path.at(3)->world_from_body).yaw_deg), 180, 1e-9);
}

// From the left at right angles: v = (-40 ahead, 62 right), so 60 m to the right needs
// ahead = 60 * 62 / 40 = 93 m.
TEST(ByApproach, WhatIsAheadFollowsFromWhatIsRight) {
  scene::Encounter encounter = head_on();
  encounter.course_deg = 90;
  const Path own = northward(40);
  const Vector3 offset = offset_at(path_to_approach(encounter, own), own, 8);
  EXPECT_NEAR(offset.x(), 93, 1e-9);
  EXPECT_NEAR(offset.y(), 60, 1e-9);
}

TEST(ByApproach, WhatIsRightFollowsFromWhatIsAhead) {
  scene::Encounter encounter = head_on();
  encounter.course_deg = 90;
  encounter.cpa_right_m.reset();
  encounter.cpa_ahead_m = 93;
  const Path own = northward(40);
  const Vector3 offset = offset_at(path_to_approach(encounter, own), own, 8);
  EXPECT_NEAR(offset.y(), 60, 1e-9);
  // All three together are good where they agree.
  encounter.cpa_right_m = 60;
  EXPECT_NO_THROW(path_to_approach(encounter, own));
}

TEST(ByApproach, CoursesAndSidesAreThoseOfTheOwnCourse) {
  const Path own = trajectory::uniform({100, 200, -150}, {0, 40, 0}, {.yaw_deg = 70});  // eastward
  const Path path = path_to_approach(head_on(), own);
  const Vector3 offset = offset_at(path, own, 8);
  EXPECT_NEAR(offset.x(), -60, 1e-9);  // right of an eastward course is south
  EXPECT_NEAR(offset.y(), 0, 1e-9);
  EXPECT_NEAR(path.at(0)->velocity_in_world_mps.y(), -62, 1e-9);
}

TEST(ByApproach, AHoveringCameraHasTheCourseOfItsHeading) {
  const Path own = trajectory::uniform({0, 0, -50}, {0, 0, 0}, {.yaw_deg = 90});
  const Vector3 offset = offset_at(path_to_approach(head_on(), own), own, 8);
  EXPECT_NEAR(offset.x(), -60, 1e-9);
  EXPECT_NEAR(offset.y(), 0, 1e-9);
}

TEST(ByApproach, TheSpeedIsAlongThePath) {
  scene::Encounter encounter = head_on();
  encounter.climb_mps = -20;
  encounter.turn_rate_dps = 3;
  const Path path = path_to_approach(encounter, northward(40));
  const auto state = path.at(2);
  EXPECT_NEAR(state->velocity_in_world_mps.norm(), 62, 1e-9);
  EXPECT_NEAR(state->velocity_in_world_mps.z(), 20, 1e-9);
  const YawPitchRoll attitude = yaw_pitch_roll(state->world_from_body);
  const double ground_mps = std::sqrt(62.0 * 62 - 20 * 20);
  EXPECT_NEAR(
      attitude.roll_deg, degrees(std::atan(ground_mps * radians(3) / kStandardGravityMps2)), 1e-9);
  EXPECT_NEAR(attitude.pitch_deg, -degrees(std::asin(20.0 / 62)), 1e-9);
  EXPECT_NEAR(std::remainder(attitude.yaw_deg - (180 + 3 * (2 - 8)), 360), 0, 1e-9);
}

// An own path that turns and climbs: a spline through a quarter circle of radius 800 m.
Path turning_own() {
  std::vector<Vector3> points;
  std::vector<double> times_s;
  for (int i = 0; i <= 20; ++i) {
    const double a = radians(6.0 * i - 15);
    points.emplace_back(800 * std::sin(a), 800 * (1 - std::cos(a)), -200 - 2.0 * i);
    times_s.push_back(-3 + 2.0 * i);
  }
  return trajectory::spline_at_times(points, times_s);
}

// The closest approach of the whole paths over a clip of 20 s, found by walking through time.
void expect_nearest_as_stated(const scene::Encounter& encounter, const Path& own) {
  const Path path = path_to_approach(encounter, own);
  const Vector3 stated = offset_at(path, own, encounter.cpa_time_s);
  const Nearest found = nearest(path, own, 0, 20);
  EXPECT_NEAR(found.distance_m, stated.norm(), 1e-4);
  EXPECT_NEAR(found.time_s, encounter.cpa_time_s, 1e-2);
  EXPECT_LT((offset_at(path, own, found.time_s) - stated).norm(), 0.1);
}

TEST(ByApproach, TheStatedApproachIsTheNearestOfTheWholePaths) {
  Random random = Seed(3).stream("approach");
  const std::vector<Path> owns = {northward(40), northward(0), turning_own()};
  int tried = 0;
  for (int i = 0; i < 300; ++i) {
    scene::Encounter encounter = head_on();
    encounter.cpa_time_s = random.uniform(3, 17);
    encounter.cpa_right_m = random.uniform(-150, 150);
    encounter.cpa_above_m = random.uniform(-80, 80);
    encounter.course_deg = random.uniform(100, 260);
    encounter.speed_mps = random.uniform(30, 120);
    encounter.climb_mps = random.uniform(-8, 8);
    encounter.turn_rate_dps = i % 3 == 0 ? random.uniform(-3, 3) : 0;
    SCOPED_TRACE(i);
    ASSERT_NO_FATAL_FAILURE(
        expect_nearest_as_stated(encounter, owns[static_cast<std::size_t>(i) % owns.size()]));
    ++tried;
  }
  EXPECT_EQ(tried, 300);
}

// ------------------------------------------------------------------------------------ bad input

std::string message_of(const scene::Encounter& encounter, const Path& own) {
  return test_support::error_of([&] { path_to_approach(encounter, own); });
}

TEST(ByApproach, NumbersThatContradictEachOtherAreAnError) {
  scene::Encounter encounter = head_on();
  encounter.cpa_ahead_m = 51;
  EXPECT_EQ(message_of(encounter, northward(40)),
            "s.toml:9:1: cpa_right_m, cpa_above_m and cpa_ahead_m are no closest approach at these "
            "velocities: the nearest place is 51.00 m further on the relative path, 0.50 s later; "
            "expected cpa_right_m or cpa_ahead_m alone, from which the other follows");
}

TEST(ByApproach, OneThatFlysAlongsideNeverComesNearest) {
  scene::Encounter encounter = head_on();
  encounter.course_deg = 0;
  encounter.speed_mps = 40;
  EXPECT_EQ(message_of(encounter, northward(40)),
            "s.toml:9:1: the intruder has the velocity of the own aircraft at cpa_time_s, so that "
            "they stay as far apart as they are; expected another course_deg, speed_mps or "
            "climb_mps");
}

TEST(ByApproach, ACrossingBeforeAHoveringCameraPassesAhead) {
  scene::Encounter encounter = head_on();
  encounter.course_deg = 90;
  EXPECT_EQ(message_of(encounter, northward(0)),
            "s.toml:9:1: no closest approach has this cpa_right_m and cpa_above_m, whatever its "
            "cpa_ahead_m: the intruder does not move ahead or back relative to the own aircraft; "
            "expected cpa_ahead_m in place of cpa_right_m");
  encounter.cpa_right_m.reset();
  encounter.cpa_ahead_m = 200;
  const Path own = northward(0);
  EXPECT_NEAR(offset_at(path_to_approach(encounter, own), own, 8).y(), 0, 1e-9);
}

TEST(ByApproach, ATimeBeyondTheOwnPathIsAnError) {
  const Path own = trajectory::spline_at_speed(std::vector<Vector3>{{0, 0, -9}, {90, 0, -9}}, 30);
  EXPECT_EQ(message_of(head_on(), own),
            "s.toml:9:1: cpa_time_s is 8.000, but the camera's path goes from 0.000 to 3.000 s; "
            "expected a time within it");
}

TEST(ByApproach, AFarthestApproachIsAnError) {
  scene::Encounter encounter = head_on();
  encounter.course_deg = 0;
  encounter.speed_mps = 50;
  encounter.cpa_right_m = 2000;
  encounter.turn_rate_dps = -10;  // towards the own aircraft
  EXPECT_NE(message_of(encounter, northward(40)).find("the paths turn so that the two are nearer"),
            std::string::npos);
}

}  // namespace
}  // namespace airtruth::placement
