// SPDX-License-Identifier: Apache-2.0
#include "encounter/passage/passage.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/random_encounter.h"

namespace airtruth::passage {
namespace {

trajectory::Path straight(const separation::Mover& mover) {
  return trajectory::uniform(mover.position_ned_m, mover.velocity_ned_mps, {});
}

// Of straight paths the closest approach in space is at -r.v / v.v, limited to the span.
TEST(Passage, TheClosestApproachOfStraightPathsIsTheClosedForm) {
  for (std::uint64_t i = 0; i < 400; ++i) {
    const test_support::Pair pair = test_support::random_pair(i);
    const separation::Relative r = separation::relative(pair.own, pair.intruder);
    const double square = r.velocity_ned_mps.squaredNorm();
    if (square < 1) continue;
    const double at_s = std::clamp(-r.offset_ned_m.dot(r.velocity_ned_mps) / square, 0.0, 60.0);
    const auto found = closest_approach(straight(pair.own), straight(pair.intruder), 0, 60);
    ASSERT_TRUE(found);
    ASSERT_NEAR(found->time_s, at_s, 1e-6) << i;
    const double distance_m = (r.offset_ned_m + at_s * r.velocity_ned_mps).norm();
    ASSERT_NEAR(found->distance_m, distance_m, 1e-6 + 1e-9 * distance_m) << i;
  }
}

// No moment of a formation is nearer than another, though rounding makes one so.
TEST(Passage, AircraftInFormationKeepTheirDistance) {
  const separation::Mover own{{41.3, 7.1, -0.9}, {40, 0.1, 0.3}};
  for (const Vector3& offset : {Vector3(30, 17.3, 0), Vector3(-0.1, 90.7, 3.3)}) {
    const separation::Mover wingman{own.position_ned_m + offset, own.velocity_ned_mps};
    const auto found = closest_approach(straight(own), straight(wingman), 0, 60);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->is_kept);
    EXPECT_EQ(found->time_s, 0);
    EXPECT_NEAR(found->distance_m, offset.norm(), 1e-9);
  }
}

// Two circles of one centre, 300 m and 500 m, one angle apart: they are nearest where both are in
// one direction, (500 - 300) m apart.
TEST(Passage, OfTurningPathsToo) {
  const auto circle = [](double radius_m, double rate_dps, double phase_deg) {
    const double speed_mps = radius_m * radians(rate_dps);
    const double phase = radians(phase_deg);
    return trajectory::steady(
        {.position_ned_m = {radius_m * std::cos(phase), radius_m * std::sin(phase), -100},
         .course_deg = phase_deg + 90,
         .ground_speed_mps = speed_mps,
         .turn_rate_dps = rate_dps});
  };
  const auto found = closest_approach(circle(300, 6, 0), circle(500, 2, 40), 0, 30);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->time_s, 10, 1e-6);
  EXPECT_NEAR(found->distance_m, 200, 1e-9);
  EXPECT_NEAR(found->offset.right_m, -200, 1e-6);  // outside of a turn to the right
  EXPECT_NEAR(found->offset.ahead_m, 0, 1e-3);
}

TEST(Passage, OnlyWhileBothAreInTheWorld) {
  const auto own = straight({{0, 0, -100}, {50, 0, 0}});
  const std::vector<Vector3> points = {{400, 30, -100}, {300, 30, -100}};
  const auto late = trajectory::shifted(trajectory::spline_at_speed(points, 50), 2);
  const auto found = closest_approach(own, late, 0, 60);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->time_s, 4, 1e-6);  // its path ends there, still 100 m ahead
  EXPECT_NEAR(found->distance_m, std::hypot(100, 30), 1e-6);
  EXPECT_TRUE(found->is_cut_off);
  EXPECT_FALSE(closest_approach(own, late, 0, 1));
  // One that flies away throughout is nearest where its path begins, which cuts nothing off.
  const std::vector<Vector3> away = {{300, 30, -100}, {900, 30, -100}};
  const auto first = closest_approach(own, trajectory::spline_at_speed(away, 60), 0, 60);
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->time_s, 0, 1e-6);
  EXPECT_FALSE(first->is_cut_off);
}

TEST(Passage, AfterTheClipAPathGoesStraightOnFromItsEnd) {
  const std::vector<Vector3> ahead = {{400, 30, -100}, {100, 30, -100}};
  const auto path = trajectory::spline_at_speed(ahead, 60);  // 5 s
  const auto on = beyond_clip(path, 4.5);
  EXPECT_LT((on.at(7)->position_in_world - Vector3(-20, 30, -100)).norm(), 1e-9);
  EXPECT_LT((on.at(3)->position_in_world - path.at(3)->position_in_world).norm(), 1e-12);
  EXPECT_FALSE(on.at(-1));
  EXPECT_FALSE(beyond_clip(path, 5.5).at(5.5));  // it is over within the clip
  // Of a path to 1.4 s and a clip whose last frame is tick 35 x 512 of 1/12800 s, a rounding later.
  const double last_s = 35 * 512 * (1 / 12800.0);
  const auto to_the_last = trajectory::spline_at_times(ahead, std::vector{0.0, 1.4});
  ASSERT_GT(last_s, to_the_last.end_s());
  EXPECT_TRUE(beyond_clip(to_the_last, last_s).at(9));
  EXPECT_TRUE(beyond_clip(trajectory::shifted(path, 3), 2).at(9));  // it begins after the clip
}

// Of straight paths, walking finds the interval of the closed form.
TEST(Passage, ViolationsOfStraightPathsAreTheClosedForm) {
  for (const separation::NamedVolume& named : separation::named_volumes()) {
    int violated = 0;
    for (std::uint64_t i = 0; i < 120; ++i) {
      const test_support::Pair pair = test_support::random_pair(i);
      const auto expected = separation::violation(named.volume, pair.own, pair.intruder, 60);
      const auto found =
          violations(named.volume, straight(pair.own), straight(pair.intruder), 0, 60);
      if (expected && expected->end_s - expected->begin_s < kStep_s) continue;
      ASSERT_EQ(found.size(), expected ? 1u : 0u) << named.name << ' ' << i;
      if (!expected) continue;
      ++violated;
      ASSERT_NEAR(found[0].begin_s, expected->begin_s, 1e-6) << named.name << ' ' << i;
      ASSERT_NEAR(found[0].end_s, expected->end_s, 1e-6) << named.name << ' ' << i;
    }
    EXPECT_GT(violated, 0) << named.name;
  }
}

// A violation far shorter than a step is found where the two are nearest: 300 m/s across a chord of
// 2 m takes 7 ms.
TEST(Passage, AShortViolationIsFoundAtTheClosestApproach) {
  const double miss_m = 152.4 - 0.5 / 152.4;
  const auto own = straight({{0, 0, -100}, {150, 0, 0}});
  const auto other = straight({{3001, miss_m, -100}, {-150, 0, 0}});
  const auto found = violations(separation::named_volume("nmac")->volume, own, other, 0, 20);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].end_s - found[0].begin_s, 2.0 / 300, 1e-4);
}

// 609.6 m apart in a turn around one centre, f3442's distance: rounding has them now inside and now
// outside. Nearer by 1 mm they are inside all along, and farther by 1 mm never.
TEST(Passage, WhatKeepsExactlyAThresholdIsOneViolation) {
  const separation::Volume& volume = separation::named_volume("f3442")->volume;
  const auto circle = [](double radius_m) {
    return trajectory::steady(
        {.position_ned_m = {1e5 + radius_m * std::cos(0.3), 2e5 + radius_m * std::sin(0.3), -100},
         .course_deg = degrees(0.3) + 90,
         .ground_speed_mps = radius_m * radians(5),
         .turn_rate_dps = 5});
  };
  const auto found = [&](double apart_m) {
    return violations(volume, circle(400), circle(400 + apart_m), 0, 70);
  };
  const auto exact = found(609.6);
  ASSERT_EQ(exact.size(), 1u);
  EXPECT_EQ(exact[0].begin_s, 0);
  EXPECT_EQ(exact[0].end_s, 70);
  const auto nearer = found(609.599);
  ASSERT_EQ(nearer.size(), 1u);
  EXPECT_EQ(nearer[0].end_s, 70);
  EXPECT_TRUE(found(609.601).empty());
}

separation::Mover flying(double course_deg, double speed_mps, double climb_mps = 0) {
  const double course = radians(course_deg);
  return {{0, 0, 0}, {speed_mps * std::cos(course), speed_mps * std::sin(course), -climb_mps}};
}

TEST(GeometryClass, CoursesAreCountedFromTheOwnCourse) {
  const separation::Mover own = flying(30, 40);
  EXPECT_EQ(meeting_of(own, flying(210, 50)), Meeting::kHeadOn);
  EXPECT_EQ(meeting_of(own, flying(185, 50)), Meeting::kHeadOn);
  EXPECT_EQ(meeting_of(own, flying(120, 50)), Meeting::kCrossingFromLeft);
  EXPECT_EQ(meeting_of(own, flying(-60, 50)), Meeting::kCrossingFromRight);
  EXPECT_EQ(meeting_of(own, flying(30, 50)), Meeting::kOvertaken);
  EXPECT_EQ(meeting_of(own, flying(60, 30)), Meeting::kOvertaking);
  EXPECT_EQ(meeting_of(own, flying(30, 40)), std::nullopt);
  EXPECT_EQ(meeting_of(flying(0, 0), flying(30, 40)), std::nullopt);
}

TEST(GeometryClass, ClimbsFromFiveHundredFeetAMinute) {
  EXPECT_EQ(vertical_motion_of(flying(0, 40, 2.55)), VerticalMotion::kClimbing);
  EXPECT_EQ(vertical_motion_of(flying(0, 40, 2.53)), VerticalMotion::kLevel);
  EXPECT_EQ(vertical_motion_of(flying(0, 40, -3)), VerticalMotion::kDescending);
}

// At 1000 m the horizon is 1.015 degrees below the level: the usual 0.0321 sqrt(h) degrees.
TEST(GeometryClass, TheHorizonDipsWithHeight) {
  const separation::Mover own{{0, 0, -1000}, {}};
  const auto at_height = [&](double down_m) {
    return against_horizon(own, {{2000, 0, down_m}, {}}, 0.1);
  };
  EXPECT_EQ(at_height(-1000), AgainstHorizon::kAbove);  // level is above the horizon
  EXPECT_EQ(at_height(-1000 + 2000 * std::tan(radians(1.015))), AgainstHorizon::kOn);
  EXPECT_EQ(at_height(-1000 + 2000 * std::tan(radians(1.2))), AgainstHorizon::kBelow);
}

}  // namespace
}  // namespace airtruth::passage
