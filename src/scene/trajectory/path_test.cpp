// SPDX-License-Identifier: Apache-2.0
#include "scene/trajectory/path.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/geometry/units.h"
#include "support/error_of.h"

namespace airtruth::trajectory {
namespace {

using Points = std::vector<Vector3>;
using test_support::error_of;

TEST(AtSpeed, TwoPointsAreAStraightLine) {
  const Path path = spline_at_speed(Points{{0, 0, -100}, {300, 400, -100}}, 50);
  EXPECT_NEAR(path.end_s(), 10, 1e-9);
  const auto state = path.at(4);
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->position_in_world.isApprox(Vector3(120, 160, -100), 1e-9));
  EXPECT_TRUE(state->velocity_in_world_mps.isApprox(Vector3(30, 40, 0), 1e-9));
  const YawPitchRoll attitude = yaw_pitch_roll(state->world_from_body);
  EXPECT_NEAR(attitude.yaw_deg, degrees(std::atan2(4, 3)), 1e-9);
  EXPECT_NEAR(attitude.pitch_deg, 0, 1e-9);
  EXPECT_NEAR(attitude.roll_deg, 0, 1e-9);
  EXPECT_FALSE(path.at(-0.01));
  EXPECT_FALSE(path.at(10.01));
}

TEST(AtSpeed, ClimbsNoseUp) {
  const Path path = spline_at_speed(Points{{0, 0, 0}, {100, 0, -100}}, 50);
  EXPECT_NEAR(yaw_pitch_roll(path.at(1)->world_from_body).pitch_deg, 45, 1e-9);
}

// An aircraft on a circle of radius R at speed v banks by atan(v^2 / (R g)), with the right wing
// down in a right turn.
TEST(AtSpeed, BanksAsACoordinatedTurn) {
  Points circle;
  const double radius = 1000;
  for (int i = 0; i <= 72; ++i) {
    const double angle = radians(5.0 * i);
    circle.emplace_back(
        // The circle turns right from north.
        radius * std::sin(angle),
        radius * (1 - std::cos(angle)),
        -300);
  }
  const Path path = spline_at_speed(circle, 100);
  for (double t = 15; t < 45; t += 0.37) {
    const YawPitchRoll attitude = yaw_pitch_roll(path.at(t)->world_from_body);
    EXPECT_NEAR(attitude.roll_deg,
                degrees(std::atan(100.0 * 100.0 / (radius * kStandardGravityMps2))),
                0.05);
  }
}

TEST(AtSpeed, FliesEveryPartAtTheStatedSpeed) {
  const Path path =
      spline_at_speed(Points{{700, -900, -350}, {760, -300, -355}, {800, 500, -360}}, 140);
  const double h = 1e-4;
  for (double t = 0.1; t < path.end_s() - 0.1; t += 0.21) {
    const Vector3 difference =
        (path.at(t + h)->position_in_world - path.at(t - h)->position_in_world) / (2 * h);
    EXPECT_NEAR(difference.norm(), 140, 1e-4);
    EXPECT_LT((difference - path.at(t)->velocity_in_world_mps).norm(), 1e-4);
  }
}

TEST(AtTimes, PassesThroughItsWaypointsAndIsSmooth) {
  const Points points = {{0, 0, 0}, {10, 5, -1}, {30, 0, 2}, {35, -20, 0}};
  const std::vector<double> times = {0, 1, 2.5, 4};
  const Path path = spline_at_times(points, times);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((path.at(times[i])->position_in_world - points[i]).norm(), 1e-12);
  const double h = 1e-5;
  // Velocity and acceleration agree from both sides of a knot.
  for (double knot : {1.0, 2.5}) {
    const Vector3 before = path.at(knot - h)->velocity_in_world_mps;
    const Vector3 at = path.at(knot)->velocity_in_world_mps;
    const Vector3 after = path.at(knot + h)->velocity_in_world_mps;
    EXPECT_LT(((at - before) / h - (after - at) / h).norm(), 1e-2);
    EXPECT_LT((after - before).norm(), 1e-2);
  }
}

TEST(AtTimes, VelocityIsTheDerivativeOfPosition) {
  const Path path = spline_at_times(Points{{0, 0, 0}, {10, 5, -1}, {30, 0, 2}, {35, -20, 0}},
                                    std::vector<double>{0, 1, 2.5, 4});
  const double h = 1e-5;
  for (double t = 0.01; t < 3.99; t += 0.083) {
    const Vector3 difference =
        (path.at(t + h)->position_in_world - path.at(t - h)->position_in_world) / (2 * h);
    EXPECT_LT((difference - path.at(t)->velocity_in_world_mps).norm(), 1e-7);
  }
}

TEST(AtTimes, KeepsTheLastHeadingWhereItFliesStraightUp) {
  // The path has three straight legs: north, east, then straight up. Along the last leg the
  // horizontal speed decays to 0.
  Points points;
  std::vector<double> times;
  const auto add = [&](double north, double east, double up) {
    times.push_back(static_cast<double>(times.size()));
    points.emplace_back(north, east, -up);
  };
  for (int i = 0; i < 8; ++i) add(10.0 * i, 0, 0);
  for (int i = 1; i < 40; ++i) add(70, 10.0 * i, 0);
  for (int i = 1; i < 60; ++i) add(70, 390, 10.0 * i);
  const Path path = spline_at_times(points, times);
  const State state = *path.at(path.end_s() - 0.5);
  ASSERT_LT(state.velocity_in_world_mps.head<2>().norm(), 1e-6);
  const Vector3 right_wing = state.world_from_body * Vector3(0, 1, 0);
  // The right wing stays across east, as before the climb, and does not jump to north.
  EXPECT_GT(std::abs(right_wing.x()), 0.999);
  const Vector3 nose = state.world_from_body * Vector3(1, 0, 0);
  EXPECT_NEAR(nose.z(), -1, 1e-9);
}

TEST(AtSpeed, FliesStraightUpWithoutAnyHeading) {
  const Path up = spline_at_speed(Points{{0, 0, 0}, {0, 0, -100}}, 10);
  EXPECT_NEAR((up.at(5)->world_from_body * Vector3(1, 0, 0)).z(), -1, 1e-9);
}

TEST(AttitudeOverride, TakesThePathsPlace) {
  const Path path =
      spline_at_speed(Points{{0, 0, 0}, {100, 0, 0}}, 50, {.yaw_deg = 90.0, .roll_deg = -20.0});
  const YawPitchRoll attitude = yaw_pitch_roll(path.at(1)->world_from_body);
  EXPECT_NEAR(attitude.yaw_deg, 90, 1e-9);
  EXPECT_NEAR(attitude.roll_deg, -20, 1e-9);
}

TEST(Shifted, BeginsLater) {
  const Path path = shifted(spline_at_speed(Points{{0, 0, 0}, {100, 0, 0}}, 50), 3);
  EXPECT_FALSE(path.at(2.9));
  EXPECT_NEAR(path.at(4)->position_in_world.x(), 50, 1e-9);
  EXPECT_NEAR(path.end_s(), 5, 1e-9);
}

TEST(Uniform, GoesOnForEver) {
  const Path path = uniform({0, 0, -150}, {40, 0, 0}, {10, 0, 0});
  EXPECT_TRUE(path.at(1e6)->position_in_world.isApprox(Vector3(4e7, 0, -150)));
}

// A level turn to the left of 90 degrees in 10 s at 50 m/s: the radius is 50 / (pi / 20) = 1000 /
// pi.
TEST(Steady, ATurnIsAnArc) {
  const Path path = steady({.position_ned_m = {10, 20, -300},
                            .time_s = 4,
                            .course_deg = 0,
                            .ground_speed_mps = 50,
                            .climb_mps = 2,
                            .turn_rate_dps = -9});
  const double radius_m = 1000 / kPi;
  const auto end = path.at(14);
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->position_in_world.isApprox(Vector3(10 + radius_m, 20 - radius_m, -320), 1e-12));
  EXPECT_TRUE(end->velocity_in_world_mps.isApprox(Vector3(0, -50, -2), 1e-12));
  const YawPitchRoll attitude = yaw_pitch_roll(end->world_from_body);
  EXPECT_NEAR(attitude.yaw_deg, -90, 1e-9);
  EXPECT_NEAR(attitude.pitch_deg, degrees(std::atan2(2, 50)), 1e-9);
  EXPECT_NEAR(attitude.roll_deg, degrees(std::atan(50 * radians(-9) / kStandardGravityMps2)), 1e-9);
}

TEST(Steady, VelocityIsTheChangeOfPosition) {
  for (const double turn_rate_dps : {0.0, 1e-9, 1e-4, 0.3, -6.0}) {
    const Path path = steady({.position_ned_m = {1, 2, -300},
                              .time_s = 3,
                              .course_deg = 250,
                              .ground_speed_mps = 70,
                              .climb_mps = -4,
                              .turn_rate_dps = turn_rate_dps});
    EXPECT_TRUE(path.at(3)->position_in_world.isApprox(Vector3(1, 2, -300), 1e-15));
    for (const double t : {-5.0, 2.9999, 3.0, 3.1, 40.0}) {
      const Vector3 moved =
          path.at(t + 1e-3)->position_in_world - path.at(t - 1e-3)->position_in_world;
      EXPECT_LT((moved / 2e-3 - path.at(t)->velocity_in_world_mps).norm(), 1e-6) << t;
    }
  }
}

TEST(Steady, OneThatHoversKeepsItsHeading) {
  const Path path = steady({.course_deg = 130, .climb_mps = 1});
  EXPECT_NEAR(yaw_pitch_roll(path.at(9)->world_from_body).yaw_deg, 130, 1e-9);
  EXPECT_EQ(path.at(9)->position_in_world, Vector3(0, 0, -9));
}

TEST(Waypoints, SayWhatIsWrong) {
  EXPECT_THAT(error_of([] {
                spline_at_speed(Points{{0, 0, 0}}, 5);
              }),
              testing::HasSubstr("at least two waypoints"));
  EXPECT_THAT(error_of([] {
                spline_at_speed(Points{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, 5);
              }),
              testing::HasSubstr("waypoints 2 and 3 are the same point [1, 0, 0]"));
  EXPECT_THAT(error_of([] {
                spline_at_speed(Points{{0, 0, NAN}, {1, 0, 0}}, 5);
              }),
              testing::HasSubstr("waypoint 1"));
  EXPECT_THAT(error_of([] {
                spline_at_speed(Points{{0, 0, 0}, {1, 0, 0}}, 0);
              }),
              testing::HasSubstr("speed_mps is 0"));
  EXPECT_THAT(
      error_of([] {
        spline_at_times(Points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, std::vector<double>{0, 2, 2});
      }),
      testing::HasSubstr("times_s[2] = 2 is not after times_s[1] = 2"));
}

TEST(PathFile, ReadsPositionsAndAnglesInAnyOrder) {
  const Path path = parse_path_csv(
      "east_m,time_s,north_m,down_m,yaw_deg\n0,0,0,-10,350\n0,1,10,-10,10\n", "own.csv");
  const auto state = path.at(0.5);
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->position_in_world.isApprox(Vector3(5, 0, -10)));
  // The interpolation takes the short way round.
  EXPECT_NEAR(yaw_pitch_roll(state->world_from_body).yaw_deg, 0, 1e-9);
}

// A camera that looks down and crosses the pole back and forth by 0.7 degrees turns no further.
TEST(PathFile, AnAttitudeGoesAcrossThePole) {
  std::string text = "time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg\n";
  for (int i = 0; i < 10; ++i)
    text +=
        std::to_string(i) + ",0,0,-100," + (i % 2 == 0 ? "10,-89.65,0\n" : "-169.9,-89.65,180\n");
  const Path path = parse_path_csv(text, "p.csv");
  for (double t = 0; t <= 9; t += 0.125) {
    const Quaternion turned = path.at(t)->world_from_body;
    EXPECT_LT(degrees(turned.angularDistance(world_from_body({10, -90, 0}))), 1) << t;
  }
}

// It flies north at 10 m/s, stands for 20 s, and leaves to the east.
TEST(PathFile, WhatStopsHoldsItsPlaceAndItsHeading) {
  std::string text = "time_s,north_m,east_m,down_m\n";
  for (int i = 0; i <= 30; ++i)
    text += std::to_string(i) + "," + std::to_string(10 * std::min(i, 5)) + "," +
            std::to_string(10 * std::max(i - 25, 0)) + ",-300\n";
  const Path path = parse_path_csv(text, "p.csv");
  const auto yaw_deg = [&](double t) {
    return yaw_pitch_roll(path.at(t)->world_from_body).yaw_deg;
  };
  const double h = 1e-3;
  for (double t = h; t < 30; t += h) {
    const State state = *path.at(t);
    // Smoothly by 90 degrees at up to 30 degrees a second: in 4.5 s.
    EXPECT_NEAR(yaw_deg(t),
                t < 20.5 ? 0
                : t > 25 ? 90
                         : 45,
                t < 20.5 || t > 25.01 ? 1e-6 : 45.001)
        << t;
    EXPECT_LT(std::abs(yaw_deg(t) - yaw_deg(t - h)), 31 * h) << t;
    EXPECT_LT((state.velocity_in_world_mps - path.at(t - h)->velocity_in_world_mps).norm(), 40 * h);
    EXPECT_NEAR(yaw_pitch_roll(state.world_from_body).pitch_deg, 0, 1e-9);
    if (t < 5 || t > 25) continue;
    EXPECT_EQ(state.position_in_world, Vector3(50, 0, -300)) << t;
    EXPECT_EQ(state.velocity_in_world_mps, Vector3::Zero()) << t;
  }
}

// A reversal along a line at v = 10 (1.015 - t), slow from 1.005 to 1.025 s.
TEST(AtTimes, AReversalTurnsTheNoseWithoutAJump) {
  Points points;
  std::vector<double> times;
  for (int i = 0; i <= 40; ++i) {
    const double t = 0.5 * i - 9;
    times.push_back(t);
    points.emplace_back(10 * (1.015 * t - 0.5 * t * t), 0, -100);
  }
  const Path path = spline_at_times(points, times);
  const auto yaw_deg = [&](double t) {
    return std::abs(yaw_pitch_roll(path.at(t)->world_from_body).yaw_deg);
  };
  EXPECT_NEAR(yaw_deg(1.004), 0, 1e-6);
  EXPECT_NEAR(yaw_deg(1.015), 90, 0.1);
  EXPECT_NEAR(yaw_deg(1.026), 180, 1e-6);
  // A smooth step by 180 degrees in 0.02 s turns by 13,500 degrees a second in its middle.
  for (double t = 1; t < 1.03; t += 1e-5)
    EXPECT_LT(std::abs(yaw_deg(t + 1e-5) - yaw_deg(t)), 0.136) << t;
}

// Slower than kCourseMps throughout, it has the heading that is stated, or north.
TEST(AtTimes, WhatIsAlwaysSlowHasNoHeadingOfItsOwn) {
  const Points points = {{0, 0, 0}, {0, 0.2, 0}, {0, 0.3, 0}};
  const std::vector<double> times = {0, 10, 20};
  EXPECT_NEAR(
      yaw_pitch_roll(spline_at_times(points, times).at(9)->world_from_body).yaw_deg, 0, 1e-9);
  EXPECT_NEAR(
      yaw_pitch_roll(spline_at_times(points, times, {.yaw_deg = 40.0}).at(9)->world_from_body)
          .yaw_deg,
      40,
      1e-9);
}

TEST(PathFile, PointsAtTheLineThatIsWrong) {
  const std::string header = "time_s,north_m,east_m,down_m\n";
  EXPECT_EQ(error_of([&] { parse_path_csv("time_s,nort_m,east_m,down_m\n", "a.csv"); }),
            "a.csv:1: unknown column 'nort_m'; did you mean 'north_m'?");
  EXPECT_THAT(error_of([&] { parse_path_csv(header + "0,0,0,0\n1,x,0,0\n", "a.csv"); }),
              testing::StartsWith("a.csv:3: north_m is 'x'"));
  EXPECT_THAT(error_of([&] { parse_path_csv(header + "0,0,0,0\n0,1,0,0\n", "a.csv"); }),
              testing::StartsWith("a.csv:3: time_s"));
  EXPECT_THAT(error_of([&] { parse_path_csv(header + "0,0,0,0\n1,1,1,1,1\n", "a.csv"); }),
              testing::StartsWith("a.csv:3: has 5 cells for 4 columns"));
  EXPECT_THAT(error_of([&] { parse_path_csv(header + "0,0,0,0\n1,1e300,0,0\n", "a.csv"); }),
              testing::StartsWith("a.csv:3: north_m is '1e300'"));
  EXPECT_THAT(error_of([&] { parse_path_csv(header + "0,0,0,0\n1,nan,0,0\n", "a.csv"); }),
              testing::StartsWith("a.csv:3: north_m is 'nan'"));
  EXPECT_THAT(error_of([&] { parse_path_csv(header + "0,0,0,0\n1,1\n", "a.csv"); }),
              testing::HasSubstr("no value for east_m"));
  EXPECT_THAT(error_of([&] { parse_path_csv(header + "0,0,0,0\n", "a.csv"); }),
              testing::HasSubstr("at least two"));
  EXPECT_THAT(error_of([&] { parse_path_csv("", "a.csv"); }), testing::HasSubstr("is empty"));
  EXPECT_THAT(error_of([&] { parse_path_csv("time_s\n", "a.csv"); }),
              testing::HasSubstr("no column north_m"));
}

}  // namespace
}  // namespace airtruth::trajectory
