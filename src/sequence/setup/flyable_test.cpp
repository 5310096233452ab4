// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/flyable.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "aircraft/fleet/fleet.h"
#include "aircraft/fleet/flight_limits.h"
#include "foundation/base/error.h"
#include "sequence/setup/world.h"

namespace airtruth::setup {
namespace {

using testing::MatchesRegex;

trajectory::Path straight(double speed_mps, double climb_mps = 0) {
  return trajectory::uniform({0, 0, -500}, {speed_mps, 0, -climb_mps}, {});
}

// A level circle of that radius at that speed, two turns of it. Its bank is atan(v^2 / (g r)).
trajectory::Path circle(double speed_mps, double radius_m) {
  std::vector<Vector3> points;
  for (int i = 0; i <= 144; ++i) {
    const double a = radians(5.0 * i);
    points.emplace_back(radius_m * std::sin(a), radius_m * (1 - std::cos(a)), -500);
  }
  return trajectory::spline_at_speed(points, speed_mps);
}

// The words of a Cessna that exceeds one limit alone.
auto is_cessna_beyond(const std::string& limit) {
  return MatchesRegex("c172/news \\(light piston\\) cannot fly its path: at [0-9.]+ s it " + limit);
}

TEST(Flyable, ACessnaAt131MetresASecondIsBeyondItsClassAndAnAirlinerIsNot) {
  EXPECT_THAT(words_beyond_limits("c172/news", straight(131), 0, 10),
              is_cessna_beyond("flies 131.0 m/s, the fastest of its class [0-9]+ m/s"));
  EXPECT_EQ(words_beyond_limits("738/738-Ryanair", straight(131), 0, 10), "");
  EXPECT_EQ(words_beyond_limits("c172/news", straight(55), 0, 10), "");
}

TEST(Flyable, EachLimitIsNamedWithItsInstantItsNumberAndTheLimit) {
  EXPECT_THAT(words_beyond_limits("738/738-Ryanair", straight(30), 0, 10),
              MatchesRegex("738/738-Ryanair \\([a-z ]+\\) cannot fly its path: at [0-9.]+ s it "
                           "flies 30.0 m/s, the slowest of its class [0-9]+ m/s"));
  EXPECT_THAT(words_beyond_limits("c172/news", straight(50, 20), 0, 10),
              is_cessna_beyond("climbs 20.0 m/s, its class at most [0-9]+ m/s"));
  EXPECT_THAT(words_beyond_limits("c172/news", straight(50, -20), 0, 10),
              is_cessna_beyond("descends 20.0 m/s, its class at most [0-9]+ m/s"));
  // 55 m/s on a radius of 124.6 m: atan(55^2 / (9.80665 x 124.6)) = 68.0 degrees.
  EXPECT_THAT(words_beyond_limits("c172/news", circle(55, 124.6), 2, 6),
              MatchesRegex("c172/news \\(light piston\\) cannot fly its path: at ([2-5]\\.[0-9]+|"
                           "6\\.00) s it banks 68.0 degrees, its class at most 60"));
}

// An attitude that is stated does not hide what the turn takes.
TEST(Flyable, TheBankIsThatOfTheTurn) {
  std::vector<Vector3> points;
  for (int i = 0; i <= 72; ++i)
    points.emplace_back(
        124.6 * std::sin(radians(5.0 * i)), 124.6 * (1 - std::cos(radians(5.0 * i))), -500);
  trajectory::AttitudeOverride level;
  level.roll_deg = 0;
  const auto path = trajectory::spline_at_speed(points, 55, level);
  EXPECT_THAT(words_beyond_limits("c172/news", path, 2, 6),
              is_cessna_beyond("banks [0-9.]+ degrees, its class at most 60"));
}

TEST(Flyable, OnlyTheTimeOfTheClipCountsAndAnUnknownTypeHasNoLimits) {
  const std::vector<Vector3> points = {
      {0, 0, -500}, {100, 0, -500}, {200, 0, -500}, {1200, 0, -500}};
  const std::vector<double> times = {0, 2, 4, 6};
  const auto path = trajectory::spline_at_times(points, times);
  EXPECT_NE(words_beyond_limits("c172/news", path, 0, 10), "");
  EXPECT_EQ(words_beyond_limits("c172/news", path, 10, 12), "");
  EXPECT_EQ(words_beyond_limits("mine.ac", straight(3000), 0, 10), "");
  EXPECT_EQ(words_beyond_limits("balloon/balloon", straight(1), 0, 10), "");
}

// A path through (0, 0, -10) and (100, 0, 10) at 50 m/s is 10 m below the ground after 2 s.
TEST(Flyable, APathBelowTheGroundIsSaidOnceForATable) {
  const auto warnings_of = [](double camera_down_m, double end_s) {
    const scene::Scene scene = scene::parse_scene(
        "[background]\nvideo = 'a.mp4'\n[lens]\nvertical_fov_deg = 50\n[camera]\n"
        "position_ned_m = [0, 0, " +
            std::to_string(camera_down_m) +
            "]\n[[distractor]]\nkind = 'balloon'\nposition_ned_m = [50, 0, -100]\n"
            "velocity_ned_mps = [0, 0, 52]\n"
            "[[distractor]]\nkind = 'bird'\ncount = 6\nspread_m = 0.5\n"
            "waypoints_ned_m = [[0, 0, -10], [100, 0, 10]]\nspeed_mps = 50\n",
        "s.toml");
    const World world = load_world(scene, {320, 240}, {});
    std::vector<std::string> said;
    warn_below_ground(scene, world, end_s, [&](const std::string& text) { said.push_back(text); });
    return said;
  };
  const auto said = warnings_of(-150, 2);
  ASSERT_EQ(said.size(), 2u);
  EXPECT_EQ(said[0],
            "s.toml:7:1: intruder 'balloon-1' is 4.0 m below the ground (down = 0) at 2.00 s");
  EXPECT_NE(said[1].find("the lowest of 6, is "), std::string::npos) << said[1];
  EXPECT_NE(said[1].find("m below the ground (down = 0) at 2.0"), std::string::npos) << said[1];
  // Not within the clip; and where the own aircraft is no higher, down = 0 is no ground.
  EXPECT_TRUE(warnings_of(-150, 0.9).empty());
  EXPECT_TRUE(warnings_of(0, 2).empty());
}

// The ranges that are drawn from are within the limits, and no class is without sense.
TEST(Flyable, WhatIsUsualIsFlyable) {
  for (const fleet::FlightLimits& c : fleet::flight_classes()) {
    EXPECT_LT(c.slowest_mps, c.usual_low_mps) << c.name;
    EXPECT_LT(c.usual_low_mps, c.usual_high_mps) << c.name;
    EXPECT_LT(c.usual_high_mps, c.fastest_mps) << c.name;
    EXPECT_LT(c.usual_bank_deg, c.most_bank_deg) << c.name;
    EXPECT_LT(c.most_bank_deg, 90) << c.name;
    EXPECT_LT(c.first_hour, c.last_hour) << c.name;
  }
}

// Every type of the installed list has a class but those that fly like no other.
TEST(Flyable, TypesOfTheListHaveAClass) {
  std::vector<fleet::Entry> entries;
  try {
    entries = fleet::list_aircraft();
  } catch (const Error&) {
    GTEST_SKIP() << "no aircraft are installed";
  }
  for (const fleet::Entry& entry : entries) {
    const std::string type = entry.name.substr(0, entry.name.find('/'));
    const bool odd = type == "balloon" || type == "bluebird" || type == "Ferry" ||
                     type == "SpaceShuttle" || type == "SR-71";
    EXPECT_EQ(fleet::flight_limits(entry.name) == nullptr, odd) << entry.name;
  }
}

}  // namespace
}  // namespace airtruth::setup
