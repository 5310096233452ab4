// SPDX-License-Identifier: Apache-2.0
#include "scene/flight_log/local_path.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"

namespace airtruth::flight_log {
namespace {

// Radii of curvature of the WGS 84 ellipsoid at a latitude (Torge 2001, eq. 4.15 and 4.16).
struct Radii {
  double meridian_m, normal_m;
};
Radii radii_at(double latitude_deg) {
  constexpr double kAxisM = 6378137, kEccentricity2 = 6.69437999014e-3;
  const double w2 = 1 - kEccentricity2 * std::pow(std::sin(radians(latitude_deg)), 2);
  return {kAxisM * (1 - kEccentricity2) / std::pow(w2, 1.5), kAxisM / std::sqrt(w2)};
}

// Flight from 47 degrees north, 8 degrees east at a constant velocity, `rate` fixes a second.
FlightLog straight(
    double north_mps, double east_mps, double up_mps, double rate, double resolution_deg = 0) {
  const Radii radii = radii_at(47);
  FlightLog log;
  for (int i = 0; i <= 60 * rate; ++i) {
    const double t = i / rate;
    Fix fix;
    fix.time_s = t;
    fix.latitude_deg = 47 + degrees(north_mps * (t - 20) / (radii.meridian_m + 500));
    fix.longitude_deg =
        8 + degrees(east_mps * (t - 20) / ((radii.normal_m + 500) * std::cos(radians(47))));
    if (resolution_deg > 0) {
      fix.latitude_deg = resolution_deg * std::round(fix.latitude_deg / resolution_deg);
      fix.longitude_deg = resolution_deg * std::round(fix.longitude_deg / resolution_deg);
    }
    fix.altitude_m = 500 + up_mps * (t - 20);
    fix.height_m = 80 + up_mps * (t - 20);
    log.fixes.push_back(fix);
  }
  return log;
}

TEST(LocalPath, MetresFollowFromTheEllipsoidsRadii) {
  for (const double rate : {1.0, 10.0, 30.0}) {
    const auto path = local_path(straight(30, -20, 2, rate), {20, {100, 200, -80}});
    EXPECT_NEAR((path.at(0)->position_in_world - Vector3(100, 200, -80)).norm(), 0, 1e-9);
    // Over some hundred metres to the north a degree of longitude shortens by millimetres.
    EXPECT_NEAR((path.at(10)->position_in_world - Vector3(400, 0, -100)).norm(), 0, 0.02) << rate;
    EXPECT_NEAR((path.at(5)->velocity_in_world_mps - Vector3(30, -20, -2)).norm(), 0, 0.01);
    EXPECT_NEAR(
        yaw_pitch_roll(path.at(5)->world_from_body).yaw_deg, degrees(std::atan2(-20, 30)), 0.02);
  }
}

// Level to the east along a parallel, across the date line: over 45 km a plane that touches the
// ellipsoid would leave it by 160 m.
TEST(LocalPath, TheFrameIsCarriedAlong) {
  FlightLog log;
  for (int i = 0; i <= 900; ++i)
    log.fixes.push_back(
        {double(i),
         60,
         std::remainder(
             179.8 + degrees(50.0 * i / ((radii_at(60).normal_m + 150) * std::cos(radians(60)))),
             360),
         150,
         {}});
  const auto path = local_path(log, {0, {0, 0, -150}});
  for (const double t : {0.0, 200.5, 900.0}) {
    EXPECT_NEAR((path.at(t)->position_in_world - Vector3(0, 50 * t, -150)).norm(), 0, 1e-3) << t;
    EXPECT_NEAR((path.at(t)->velocity_in_world_mps - Vector3(0, 50, 0)).norm(), 0, 1e-5) << t;
  }
}

// At ten positions a second the mean of the first half second is 0.2 s after the first one.
TEST(LocalPath, APathGoesOnForOneAndAHalfSecondsFromTheFirstAndTheLastPosition) {
  const auto path = local_path(straight(30, -20, 2, 10), {-1.5, {0, 0, 0}});
  ASSERT_TRUE(path.at(0));
  EXPECT_NEAR((path.at(5)->position_in_world - Vector3(150, -100, -10)).norm(), 0, 0.02);
  EXPECT_NEAR(path.end_s(), 63, 1e-9);
}

// A circle of 60 m at 12 m/s, whose log begins with the clip.
TEST(LocalPath, ATurnBeginsWithTheLog) {
  const Radii radii = radii_at(47);
  FlightLog log;
  for (int i = 0; i <= 600; ++i) {
    const double angle = i / 30.0 * 12 / 60;
    Fix& fix = log.fixes.emplace_back();
    fix.time_s = i / 30.0;
    fix.latitude_deg = 47 + degrees(60 * std::sin(angle) / (radii.meridian_m + 500));
    fix.longitude_deg =
        8 + degrees(60 * (1 - std::cos(angle)) / ((radii.normal_m + 500) * std::cos(radians(47))));
    fix.altitude_m = 500;
  }
  const auto path = local_path(log, {0, {0, 0, 0}});
  EXPECT_LT((path.at(0)->velocity_in_world_mps - Vector3(12, 0, 0)).norm(), 0.5);
  const double after_s = 0.5, angle = after_s * 12 / 60;
  EXPECT_LT((path.at(after_s)->velocity_in_world_mps -
             Vector3(12 * std::cos(angle), 12 * std::sin(angle), 0))
                .norm(),
            0.1);
}

TEST(LocalPath, APositionOfOneMicrodegreeDoesNotShake) {
  const auto path = local_path(straight(12, 9, 0, 30, 1e-6), {20, {0, 0, 0}});
  for (double t = 0.5; t <= 9.5; t += 0.1) {
    EXPECT_LT((path.at(t)->velocity_in_world_mps - Vector3(12, 9, 0)).norm(), 0.25);
    EXPECT_LT((path.at(t)->position_in_world - Vector3(12 * t, 9 * t, 0)).norm(), 0.1);
  }
}

// A log that holds each position of a receiver for so many records; the height is a barometer's.
FlightLog held(FlightLog log, int records = 50) {
  FlightLog result;
  for (std::size_t i = 0; i + 1 < log.fixes.size(); ++i)
    for (int part = 0; part < records; ++part) {
      const double share = part / static_cast<double>(records);
      Fix& fix = result.fixes.emplace_back(log.fixes[i]);
      fix.time_s += share * (log.fixes[i + 1].time_s - fix.time_s);
      fix.altitude_m += share * (log.fixes[i + 1].altitude_m - fix.altitude_m);
    }
  return result;
}

TEST(LocalPath, PositionsThatALogRepeatsAreThoseOfTheirFirstRecords) {
  // Receivers of 1, 1.25, 5/6 and 0.5 positions a second.
  for (const auto& [rate, records] :
       std::vector<std::pair<double, int>>{{1, 50}, {1, 2}, {1.25, 2}, {5.0 / 6, 2}, {0.5, 2}}) {
    const auto path = local_path(held(straight(15, 20, 2, rate), records), {20, {0, 0, 0}});
    for (double t = -5; t <= 40 - 1 / rate; t += 0.25) {
      EXPECT_LT((path.at(t)->velocity_in_world_mps - Vector3(15, 20, -2)).norm(), 0.1) << t;
      EXPECT_LT((path.at(t)->position_in_world - Vector3(15, 20, -2) * t).norm(), 0.1) << t;
    }
  }
}

// It stands for 30 s and flies away at 10 m/s: no step within a record follows, only the overshoot
// of a spline at a speed that begins at once.
TEST(LocalPath, AHoverIsNoRepetition) {
  FlightLog log = straight(0, 0, 0, 1);
  for (int i = 31; i <= 60; ++i) log.fixes[i].latitude_deg += degrees((i - 30) * 10 / 6.367e6);
  const auto path = local_path(held(log), {0, {0, 0, 0}});
  for (double t = 1; t <= 28; t += 0.25) EXPECT_LT(path.at(t)->position_in_world.norm(), 0.3) << t;
  for (double t = 30; t <= 59; t += 0.25)
    EXPECT_LT(path.at(t)->velocity_in_world_mps.norm(), 15) << t;
}

TEST(LocalPath, AttitudesAreInterpolatedAcrossNorth) {
  FlightLog log = straight(30, 0, 0, 5);
  for (int i = 0; i <= 60; ++i)
    log.attitudes.push_back({double(i), {std::fmod(330.0 + i, 360.0), 2, 0}});
  const auto path = local_path(log, {25.5, {0, 0, 0}});
  for (const double t : {0.0, 2.0, 4.7, 9.9}) {
    const double yaw = yaw_pitch_roll(path.at(t)->world_from_body).yaw_deg;
    EXPECT_NEAR(std::remainder(yaw - (355.5 + t), 360.0), 0, 0.01) << t;
  }
  EXPECT_NEAR(attitude_at(log, 30.5)->pitch_deg, 2, 1e-12);
  EXPECT_NEAR(height_at(straight(0, 10, 2, 1), 25).value(), 90, 1e-9);
}

// A gimbal that looks down and crosses the pole back and forth by 0.7 degrees turns no further.
TEST(LocalPath, AttitudesAreInterpolatedAcrossThePole) {
  FlightLog log;
  for (int i = 0; i < 10; ++i)
    log.attitudes.push_back(
        {double(i), i % 2 == 0 ? YawPitchRoll{10, -89.65, 0} : YawPitchRoll{-169.9, -89.65, 180}});
  for (double t = 0; t <= 9; t += 0.125) {
    const YawPitchRoll turned = attitude_at(log, t).value();
    EXPECT_GE(turned.pitch_deg, -90) << t;
    EXPECT_LT(degrees(world_from_body(turned).angularDistance(world_from_body({10, -90, 0}))), 1)
        << t;
  }
}

// Positions are averaged over half seconds, attitudes are not.
TEST(LocalPath, ARollOfTwoHertzIsFollowed) {
  FlightLog log = straight(30, 0, 0, 5);
  const auto roll_deg = [](double log_s) { return 8 * std::sin(2 * kPi * 2 * log_s); };
  for (int i = 0; i <= 3000; ++i) log.attitudes.push_back({i / 50.0, {0, 0, roll_deg(i / 50.0)}});
  const auto path = local_path(log, {20, {0, 0, 0}});
  for (const double t : {0.0, 0.125, 0.21, 0.375, 3.333, 9.9})
    EXPECT_NEAR(yaw_pitch_roll(path.at(t)->world_from_body).roll_deg, roll_deg(20 + t), 0.07) << t;
}

TEST(LocalPath, AJumpAcrossTheWorldIsRefused) {
  FlightLog log = straight(30, -20, 2, 1);
  log.fixes[31].latitude_deg += 2;
  try {
    local_path(log, {20, {0, 0, 0}});
    ADD_FAILURE() << "expected an error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                testing::MatchesRegex("the log's positions jump 22[0-9]{4} m in 1.00 s at 31.00 s "
                                      "of the log; expected less than 10000 m/s"));
  }
}

// As positions, attitudes hold for 1.5 s beyond their ends.
TEST(LocalPath, APathEndsWhereItsAttitudesEnd) {
  FlightLog log = straight(30, 0, 0, 5);
  for (int i = 0; i <= 100; ++i) log.attitudes.push_back({10 + i / 10.0, {5, 0, 0}});
  EXPECT_NEAR(local_path(log, {9, {0, 0, 0}}).end_s(), 12.5, 1e-9);
  EXPECT_NEAR(local_path(log, {9, {0, 0, 0}}).start_s(), -0.5, 1e-9);
  EXPECT_THROW(local_path(log, {8, {0, 0, 0}}), Error);
  EXPECT_THROW(local_path(log, {22, {0, 0, 0}}), Error);
}

TEST(LocalPath, ALogOfAnotherTimeIsRefused) {
  const FlightLog log = straight(30, 0, 0, 1);
  EXPECT_NO_THROW(local_path(log, {-1, {0, 0, 0}}));
  try {
    local_path(log, {100, {0, 0, 0}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "the log's positions go from 0.00 to 60.00 s, and the clip begins at 100.000 s of the "
        "log; expected a log of the same flight, or another log_offset_s");
  }
}

}  // namespace
}  // namespace airtruth::flight_log
