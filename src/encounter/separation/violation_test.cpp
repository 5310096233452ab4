// SPDX-License-Identifier: Apache-2.0
#include "encounter/separation/violation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "foundation/geometry/units.h"
#include "support/random_encounter.h"

namespace airtruth::separation {
namespace {

const Volume& volume(const char* name) { return named_volume(name)->volume; }

TEST(Volumes, ThresholdsAreThoseOfTheDocuments) {
  EXPECT_EQ(named_volumes().size(), 7u);
  EXPECT_NEAR(volume("do365-phase1").horizontal_m, 1222.32, 1e-9);
  EXPECT_NEAR(volume("do365-phase1").vertical_m, 137.16, 1e-9);
  EXPECT_EQ(volume("do365-phase1").tau_s, 35);
  EXPECT_NEAR(volume("do365-preventive").vertical_m, 213.36, 1e-9);
  EXPECT_NEAR(volume("do365-terminal").horizontal_m, 457.2, 1e-9);
  EXPECT_NEAR(volume("do365-non-cooperative").horizontal_m, 670.56, 1e-9);
  EXPECT_EQ(volume("do365-buffered").horizontal_m, 1852);
  EXPECT_EQ(volume("do365-buffered").coaltitude_s, 20);
  EXPECT_NEAR(volume("f3442").horizontal_m, 609.6, 1e-9);
  EXPECT_NEAR(volume("f3442").vertical_m, 76.2, 1e-9);
  EXPECT_NEAR(volume("nmac").horizontal_m, 152.4, 1e-9);
  EXPECT_NEAR(volume("nmac").vertical_m, 30.48, 1e-9);
  EXPECT_EQ(named_volume("do365"), nullptr);
}

// Head-on at the same height, without a tau: the circle of 152.4 m is entered and left 152.4 / 200
// s before and after the closest approach at 20 s.
TEST(Violation, HeadOnThroughTheNearMidAirCollision) {
  const Mover own{{0, 0, -1000}, {100, 0, 0}};
  const Mover intruder{{4000, 0, -1000}, {-100, 0, 0}};
  const auto nmac = violation(volume("nmac"), own, intruder, 180);
  ASSERT_TRUE(nmac);
  EXPECT_NEAR(nmac->begin_s, 20 - 152.4 / 200, 1e-8);
  EXPECT_NEAR(nmac->end_s, 20 + 152.4 / 200, 1e-8);
  EXPECT_FALSE(is_inside(volume("nmac"), own, intruder));
  EXPECT_FALSE(violation(volume("nmac"), own, intruder, 19));
  EXPECT_DOUBLE_EQ(violation(volume("nmac"), own, intruder, 20)->end_s, 20);
}

// With tau: tau_mod = (x^2 - D^2) / (200 x) = 35 s gives x = 3500 + sqrt(3500^2 + D^2).
TEST(Violation, TheTauBeginsBeforeTheCircle) {
  const Mover own{{0, 0, -1000}, {100, 0, 0}};
  const Mover intruder{{20000, 0, -1000}, {-100, 0, 0}};
  const double d_m = 0.66 * kMetresOfNauticalMile;
  const double begins_m = 3500 + std::sqrt(3500.0 * 3500 + d_m * d_m);
  const auto lost = violation(volume("do365-phase1"), own, intruder, 180);
  ASSERT_TRUE(lost);
  EXPECT_NEAR(lost->begin_s, (20000 - begins_m) / 200, 1e-8);
  EXPECT_NEAR(lost->end_s, (20000 + d_m) / 200, 1e-8);
}

// 400 m above and sinking at 10 m/s onto one that keeps its height, side by side: the co-altitude
// threshold of 20 s begins 200 m above, which is outside the slab of 137 m.
TEST(Violation, TheCoAltitudeThresholdBeginsBeforeTheSlab) {
  const Mover own{{0, 0, -1000}, {50, 0, 0}};
  const Mover intruder{{0, 300, -1400}, {50, 0, 10}};
  const auto lost = violation(volume("do365-buffered"), own, intruder, 180);
  ASSERT_TRUE(lost);
  EXPECT_DOUBLE_EQ(lost->begin_s, 20);
  EXPECT_NEAR(lost->end_s, (400 + 450 * kMetresOfFoot) / 10, 1e-6);
  const auto without = violation(volume("do365-phase1"), own, intruder, 180);
  EXPECT_NEAR(without->begin_s, (400 - 450 * kMetresOfFoot) / 10, 1e-6);
}

// 609.6 m abeam on any course: rounding of the distance does not decide, 1 mm does.
TEST(Violation, WhatKeepsExactlyAThresholdIsInside) {
  for (int course_deg = 0; course_deg < 360; ++course_deg) {
    const double course = radians(course_deg + 0.3);
    const Vector3 ahead(std::cos(course), std::sin(course), 0);
    const Vector3 right(-std::sin(course), std::cos(course), 0);
    const Mover own{{1e5, -2e5, -1000}, 40 * ahead};
    const auto abeam = [&](double distance_m) {
      return Mover{own.position_ned_m + distance_m * right, own.velocity_ned_mps};
    };
    EXPECT_TRUE(is_inside(volume("f3442"), own, abeam(609.6))) << course_deg;
    EXPECT_TRUE(violation(volume("f3442"), own, abeam(609.6), 60)) << course_deg;
    EXPECT_FALSE(is_inside(volume("f3442"), own, abeam(609.601))) << course_deg;
    EXPECT_FALSE(violation(volume("f3442"), own, abeam(609.601), 60)) << course_deg;
  }
}

TEST(Violation, WhatStaysStaysInsideOrOutside) {
  const Mover own{{0, 0, -1000}, {50, 0, 0}};
  const auto inside = violation(volume("f3442"), own, {{600, 0, -1076}, {50, 0, 0}}, 60);
  ASSERT_TRUE(inside);
  EXPECT_EQ(inside->begin_s, 0);
  EXPECT_EQ(inside->end_s, 60);
  EXPECT_FALSE(violation(volume("f3442"), own, {{610, 0, -1076}, {50, 0, 0}}, 60));
  EXPECT_FALSE(violation(volume("f3442"), own, {{600, 0, -1077}, {50, 0, 0}}, 60));
}

// The definition of a volume, written once more from the separation alone: tau_mod by the time
// derivative of the squared distance, and the closest approach by the angle at the intruder.
bool defined_inside(const Volume& volume, const Vector3& s, const Vector3& v) {
  const double distance_m = std::hypot(s.x(), s.y());
  const double speed_mps = std::hypot(v.x(), v.y());
  bool near = distance_m <= volume.horizontal_m;
  const double half_derivative = s.x() * v.x() + s.y() * v.y();
  if (!near && half_derivative < 0) {
    const double cosine = -half_derivative / (distance_m * speed_mps);
    const double miss_m = distance_m * std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double tau_s =
        (distance_m * distance_m - volume.horizontal_m * volume.horizontal_m) / -half_derivative;
    near = miss_m <= volume.horizontal_m && tau_s <= volume.tau_s;
  }
  bool level = std::abs(s.z()) <= volume.vertical_m;
  if (!level && s.z() * v.z() < 0) level = -s.z() / v.z() <= volume.coaltitude_s;
  return near && level;
}

// Every instant of a walk agrees with the interval, but for those within a rounding of its ends.
void expect_walk_agrees(const Volume& volume,
                        const test_support::Pair& pair,
                        std::uint64_t i,
                        int& violated) {
  constexpr double kLookahead_s = 180;
  constexpr double kStep_s = 0.5;
  constexpr double kRounding_s = 1e-6;
  const Relative between = relative(pair.own, pair.intruder);
  const auto inside_at = [&](double t) {
    return defined_inside(
        volume, between.offset_ned_m + t * between.velocity_ned_mps, between.velocity_ned_mps);
  };
  const auto found = violation(volume, pair.own, pair.intruder, kLookahead_s);
  for (double t = 0; t <= kLookahead_s; t += kStep_s) {
    const bool near_end = found && (std::abs(t - found->begin_s) < kRounding_s ||
                                    std::abs(t - found->end_s) < kRounding_s);
    if (near_end) continue;
    const bool expected = found && t > found->begin_s && t < found->end_s;
    ASSERT_EQ(inside_at(t), expected) << "pair " << i << " at " << t << " s";
  }
  if (!found) return;
  ++violated;
  ASSERT_LE(found->begin_s, found->end_s);
  if (found->end_s - found->begin_s > 2 * kRounding_s) {
    ASSERT_TRUE(inside_at(0.5 * (found->begin_s + found->end_s))) << i;
  }
  if (found->begin_s > kRounding_s) {
    ASSERT_FALSE(inside_at(found->begin_s - kRounding_s)) << i;
  }
  if (found->end_s < kLookahead_s) {
    ASSERT_FALSE(inside_at(found->end_s + kRounding_s)) << i;
  }
}

TEST(Violation, AgreesWithWalkingThroughTimeOnTenThousandPairs) {
  for (const NamedVolume& named : named_volumes()) {
    int violated = 0;
    for (std::uint64_t i = 0; i < 10'000; ++i) {
      const test_support::Pair pair = test_support::random_pair(i);
      ASSERT_NO_FATAL_FAILURE(expect_walk_agrees(named.volume, pair, i, violated)) << named.name;
      const bool now = defined_inside(named.volume,
                                      pair.intruder.position_ned_m - pair.own.position_ned_m,
                                      pair.intruder.velocity_ned_mps - pair.own.velocity_ned_mps);
      ASSERT_EQ(is_inside(named.volume, pair.own, pair.intruder), now) << named.name << ' ' << i;
    }
    EXPECT_GT(violated, 100) << named.name;
    EXPECT_LT(violated, 9000) << named.name;
  }
}

}  // namespace
}  // namespace airtruth::separation
