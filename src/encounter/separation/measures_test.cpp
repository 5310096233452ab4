// SPDX-License-Identifier: Apache-2.0
#include "encounter/separation/measures.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "foundation/geometry/units.h"
#include "support/random_encounter.h"

namespace airtruth::separation {
namespace {

TEST(Measures, HeadOnWithAnOffset) {
  const Mover own{{0, 0, -1000}, {100, 0, 0}};
  const Mover intruder{{4000, 200, -1300}, {-100, 0, 5}};
  const Measures m = measures(own, intruder);
  EXPECT_DOUBLE_EQ(m.range_m, std::sqrt(4000.0 * 4000 + 200 * 200 + 300 * 300));
  EXPECT_DOUBLE_EQ(m.horizontal_m, std::hypot(4000, 200));
  EXPECT_DOUBLE_EQ(m.above_m, 300);
  EXPECT_DOUBLE_EQ(*m.closing_speed_mps, (4000 * 200 + 300 * 5) / m.range_m);
  EXPECT_DOUBLE_EQ(*m.bearing_deg, degrees(std::atan2(200, 4000)));
  EXPECT_DOUBLE_EQ(*m.relative_bearing_deg, *m.bearing_deg);
  // The bearing grows as the intruder comes abreast on the right: d/dt atan2(200, x) with x' =
  // -200.
  EXPECT_DOUBLE_EQ(*m.bearing_rate_dps, degrees(200.0 * 200 / (m.horizontal_m * m.horizontal_m)));
  EXPECT_DOUBLE_EQ(*m.tcpa_s, 20);
  EXPECT_DOUBLE_EQ(*m.dcpa_m, 200);
  EXPECT_DOUBLE_EQ(m.hmd_m, 200);
  EXPECT_DOUBLE_EQ(*m.tcoa_s, 60);
  EXPECT_DOUBLE_EQ(m.vmd_m, 0);
  const double dmod_m = 0.66 * kMetresOfNauticalMile;
  EXPECT_NEAR(*m.tau_mod_s, (4000.0 * 4000 + 200 * 200 - dmod_m * dmod_m) / (4000 * 200), 1e-12);
}

TEST(Measures, BearingsCountFromNorthAndFromTheOwnCourse) {
  const Mover own{{0, 0, -100}, {0, 50, 0}};  // eastward
  const Measures west = measures(own, {{0, -300, -100}, {0, 0, 0}});
  EXPECT_DOUBLE_EQ(*west.bearing_deg, 270);
  EXPECT_DOUBLE_EQ(*west.relative_bearing_deg, 180);
  const Measures south = measures(own, {{-300, 0, -100}, {0, 0, 0}});
  EXPECT_DOUBLE_EQ(*south.bearing_deg, 180);
  EXPECT_DOUBLE_EQ(*south.relative_bearing_deg, 90);
  const Measures north = measures(own, {{300, 0, -100}, {0, 0, 0}});
  EXPECT_DOUBLE_EQ(*north.bearing_deg, 0);
  EXPECT_DOUBLE_EQ(*north.relative_bearing_deg, -90);
}

TEST(Measures, WhatIsNotDefinedIsEmpty) {
  const Mover own{{0, 0, -500}, {40, 0, 0}};
  const Measures parallel = measures(own, {{300, 40, -500}, {40, 0, 0}});
  EXPECT_FALSE(parallel.tcpa_s || parallel.dcpa_m || parallel.tau_mod_s || parallel.tcoa_s);
  EXPECT_DOUBLE_EQ(parallel.hmd_m, std::hypot(300, 40));
  EXPECT_DOUBLE_EQ(*parallel.closing_speed_mps, 0);

  const Measures diverging = measures(own, {{300, 40, -600}, {90, 0, -2}});
  EXPECT_FALSE(diverging.tcpa_s || diverging.dcpa_m || diverging.tau_mod_s || diverging.tcoa_s);
  EXPECT_LT(*diverging.closing_speed_mps, 0);
  EXPECT_DOUBLE_EQ(diverging.vmd_m, 100);

  const Measures above = measures(own, {{0, 0, -700}, {0, 0, 0}});
  EXPECT_FALSE(above.bearing_deg || above.bearing_rate_dps || above.relative_bearing_deg);
  EXPECT_TRUE(above.line_of_sight_rate_dps);

  const Measures same_place = measures(own, {{0, 0, -500}, {0, 10, 0}});
  EXPECT_FALSE(same_place.closing_speed_mps || same_place.line_of_sight_rate_dps);
  EXPECT_DOUBLE_EQ(*same_place.tcpa_s, 0);

  const Measures hovering = measures({{0, 0, -50}, {0, 0, 0}}, {{200, 0, -50}, {0, 0, 0}});
  EXPECT_FALSE(hovering.relative_bearing_deg || hovering.tcpa_s);
  EXPECT_DOUBLE_EQ(*hovering.bearing_deg, 0);
}

TEST(Measures, InsideTheTauDistanceThereIsNoModifiedTau) {
  const Mover own{{0, 0, -500}, {40, 0, 0}};
  EXPECT_FALSE(measures(own, {{1000, 0, -500}, {-40, 0, 0}}).tau_mod_s);
  EXPECT_TRUE(measures(own, {{1300, 0, -500}, {-40, 0, 0}}).tau_mod_s);
}

// Abeam, what rounding leaves of the closing speed gives no tau: 1e-12 m/s would be 1e16 s.
TEST(Measures, AClosingSpeedOfRoundingGivesNoTau) {
  for (const double closing_mps : {1e-16, 1e-13, 1e-12, 1e-10}) {
    const Measures abeam =
        measures({{0, 0, -500}, {0, 0, 0}}, {{3000, 0, -500}, {-closing_mps, 40, 0}});
    EXPECT_FALSE(abeam.tau_mod_s) << closing_mps;
    EXPECT_TRUE(abeam.dcpa_m) << closing_mps;
  }
  const Measures slow = measures({{0, 0, -500}, {0, 0, 0}}, {{3000, 0, -500}, {-1e-3, 40, 0}});
  const double dmod_m = 0.66 * kMetresOfNauticalMile;
  EXPECT_NEAR(slow.tau_mod_s.value(), (3000.0 * 3000 - dmod_m * dmod_m) / (3000 * 1e-3), 1e-3);
}

TEST(Measures, MissDistancesLookNoFurtherThanTheLookahead) {
  const Mover own{{0, 0, -1000}, {100, 0, 0}};
  const Mover intruder{{4000, 200, -1300}, {-100, 0, 5}};
  const Measures m = measures(own, intruder, {.lookahead_s = 10});
  EXPECT_DOUBLE_EQ(m.hmd_m, std::hypot(4000 - 10 * 200, 200));
  EXPECT_DOUBLE_EQ(m.vmd_m, 300 - 10 * 5);
}

bool is_finite(const std::optional<double>& value) { return !value || std::isfinite(*value); }

// The same quantities from the separation as a function of time, walked in small steps.
struct Walked {
  double hmd_m = 1e300, vmd_m = 1e300, at_s = 0;
};
Walked walked(const test_support::Pair& pair, double lookahead_s, double step_s) {
  const Relative between = relative(pair.own, pair.intruder);
  Walked result;
  const auto steps = static_cast<int>(std::lround(lookahead_s / step_s));
  for (int i = 0; i <= steps; ++i) {
    const double t = lookahead_s * i / steps;
    const Vector3 then = between.offset_ned_m + t * between.velocity_ned_mps;
    const double horizontal_m = std::hypot(then.x(), then.y());
    if (horizontal_m < result.hmd_m) result.at_s = t;
    result.hmd_m = std::min(result.hmd_m, horizontal_m);
    result.vmd_m = std::min(result.vmd_m, std::abs(then.z()));
  }
  return result;
}

TEST(Measures, AgreeWithWalkingThroughTimeOnTenThousandPairs) {
  constexpr double kStep_s = 0.05;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const test_support::Pair pair = test_support::random_pair(i);
    const Measures m = measures(pair.own, pair.intruder);
    const Walked walk = walked(pair, 180, kStep_s);
    const Vector3 v = pair.intruder.velocity_ned_mps - pair.own.velocity_ned_mps;
    const double step_m = 0.5 * kStep_s * v.head<2>().norm() + 1e-6;
    ASSERT_LE(m.hmd_m, walk.hmd_m + 1e-6) << i;
    ASSERT_GE(m.hmd_m, walk.hmd_m - step_m) << i;
    ASSERT_LE(m.vmd_m, walk.vmd_m + 1e-6) << i;
    ASSERT_GE(m.vmd_m, walk.vmd_m - 0.5 * kStep_s * std::abs(v.z()) - 1e-6) << i;
    if (m.tcpa_s && *m.tcpa_s < 180) {
      ASSERT_NEAR(*m.tcpa_s, walk.at_s, 0.51 * kStep_s) << i;
    }
    for (const auto& value : {m.closing_speed_mps,
                              m.bearing_deg,
                              m.bearing_rate_dps,
                              m.relative_bearing_deg,
                              m.line_of_sight_rate_dps,
                              m.tcpa_s,
                              m.dcpa_m,
                              m.tau_mod_s,
                              m.tcoa_s})
      ASSERT_TRUE(is_finite(value)) << i;
  }
}

// Rates from differences of the values half a millisecond before and after.
TEST(Measures, RatesAreTheChangesOfTheValues) {
  constexpr double kHalf_s = 0.5e-3;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const test_support::Pair pair = test_support::random_pair(i);
    const auto moved = [](const Mover& mover, double t) {
      return Mover{mover.position_ned_m + t * mover.velocity_ned_mps, mover.velocity_ned_mps};
    };
    const Relative before = relative(moved(pair.own, -kHalf_s), moved(pair.intruder, -kHalf_s));
    const Relative after = relative(moved(pair.own, kHalf_s), moved(pair.intruder, kHalf_s));
    const Measures m = measures(pair.own, pair.intruder);
    if (m.range_m < 20 || m.horizontal_m < 20) continue;
    const double closing_mps =
        (before.offset_ned_m.norm() - after.offset_ned_m.norm()) / (2 * kHalf_s);
    ASSERT_NEAR(*m.closing_speed_mps, closing_mps, 1e-3 + 1e-5 * std::abs(closing_mps)) << i;
    const double sine =
        before.offset_ned_m.normalized().cross(after.offset_ned_m.normalized()).norm();
    const double sight_dps = degrees(std::asin(std::min(1.0, sine))) / (2 * kHalf_s);
    ASSERT_NEAR(*m.line_of_sight_rate_dps, sight_dps, 1e-3 + 1e-4 * sight_dps) << i;
    const double turned_rad =
        std::remainder(std::atan2(after.offset_ned_m.y(), after.offset_ned_m.x()) -
                           std::atan2(before.offset_ned_m.y(), before.offset_ned_m.x()),
                       2 * kPi);
    const double bearing_dps = degrees(turned_rad) / (2 * kHalf_s);
    ASSERT_NEAR(*m.bearing_rate_dps, bearing_dps, 1e-3 + 1e-4 * std::abs(bearing_dps)) << i;
  }
}

}  // namespace
}  // namespace airtruth::separation
