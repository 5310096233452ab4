// SPDX-License-Identifier: Apache-2.0
#include "scene/flight_log/log_rates.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/geometry/within_frame.h"

namespace airtruth::flight_log {
namespace {

constexpr double kOffsetS = 37.2;

// The attitude of an aircraft that never repeats a turn within the log's two minutes.
YawPitchRoll attitude_at_time(double t) {
  return {40 * std::sin(0.11 * t) + 8 * std::sin(0.83 * t + 1),
          6 * std::sin(0.37 * t) + 2 * std::sin(1.9 * t),
          25 * std::sin(0.19 * t + 0.5) + 6 * std::sin(1.3 * t)};
}

FlightLog flown(double records_hz, double duration_s = 120) {
  FlightLog log;
  for (int i = 0; i <= duration_s * records_hz; ++i)
    log.attitudes.push_back({i / records_hz, attitude_at_time(i / records_hz)});
  return log;
}

// What a camera that is tilted in the aircraft measures over ten seconds from kOffsetS on.
std::vector<motion::FrameMotion> measured(double scale = 1) {
  const Quaternion body_from_cam = world_from_body({3, -12, 2}) * cam_from_body().conjugate();
  const auto world_from_cam = [&](double t) {
    YawPitchRoll a = attitude_at_time(t);
    return world_from_body({scale * a.yaw_deg, scale * a.pitch_deg, scale * a.roll_deg}) *
           body_from_cam;
  };
  std::vector<motion::FrameMotion> motion;
  for (int k = 0; k < 300; ++k) {
    motion::FrameMotion frame;
    frame.frame = k;
    frame.time_s = k / 30.0;
    frame.rotation = world_from_cam(kOffsetS + frame.time_s).conjugate() * world_from_cam(kOffsetS);
    frame.state = k == 0 ? motion::State::kReference : motion::State::kMeasured;
    motion.push_back(frame);
  }
  return motion;
}

TEST(LogRates, TheOffsetOfAKnownFlightIsFound) {
  for (const double hz : {200.0, 50.0, 5.0}) {
    const Alignment found = aligned(gyro_samples(flown(hz)), measured());
    ASSERT_TRUE(found.fit) << found.why;
    EXPECT_NEAR(found.fit->offset_s, kOffsetS, 0.02) << hz;
    EXPECT_LT(found.fit->offset_sigma_s, 0.02);
    EXPECT_LT(found.other_correlation, 0.97);
  }
}

// The rates of such a log end half a record before its attitudes.
TEST(LogRates, TheOffsetOfALogThatEndsWithTheClipIsFound) {
  const double clip_s = measured().back().time_s;
  for (const double hz : {30.0, 10.0}) {
    const Alignment found = aligned(gyro_samples(flown(hz, kOffsetS + clip_s)), measured());
    ASSERT_TRUE(found.fit) << found.why;
    EXPECT_NEAR(found.fit->offset_s, kOffsetS, 0.005) << hz;
  }
  EXPECT_THAT(aligned(gyro_samples(flown(50, kOffsetS + clip_s - 0.5)), measured()).why,
              testing::HasSubstr("where it does not cover the clip"));
}

TEST(LogRates, RatesAreThoseOfTheAttitudes) {
  FlightLog log;
  for (int i = 0; i < 400; ++i) log.attitudes.push_back({i / 200.0, {30 * i / 200.0, 0, 0}});
  for (const gyro::GyroSample& sample : gyro_samples(log))
    EXPECT_NEAR((sample.rate_radps - Vector3(0, 0, radians(30))).norm(), 0, 1e-9);
}

TEST(LogRates, AClipThatDoesNotTurnOrIsOfAnotherFlightIsRefused) {
  EXPECT_FALSE(aligned(gyro_samples(flown(50)), measured(0)).fit);
  EXPECT_THAT(aligned(gyro_samples(flown(50, 5)), measured()).why,
              testing::StartsWith("it lasts 5.0 s and the clip 10.0 s"));
  // The same turn again and again fits at many offsets.
  FlightLog weaving;
  for (int i = 0; i <= 2000; ++i)
    weaving.attitudes.push_back({i / 50.0, {10 * std::sin(i / 50.0 * kPi), 0, 0}});
  std::vector<motion::FrameMotion> motion = measured();
  for (motion::FrameMotion& frame : motion)
    frame.rotation =
        (world_from_body({10 * std::sin(frame.time_s * kPi), 0, 0}) * cam_from_body().conjugate())
            .conjugate() *
        cam_from_body().conjugate();
  EXPECT_THAT(aligned(gyro_samples(weaving), motion).why,
              testing::HasSubstr("expected a clip with turns that occur once"));
}

}  // namespace
}  // namespace airtruth::flight_log
