// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/drawn_rule.h"

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "aircraft/fleet/flight_limits.h"
#include "dataset/build/plan.h"
#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"
#include "sequence/setup/from_scene.h"
#include "support/error_of.h"
#include "support/small_catalogue.h"

namespace airtruth::catalogue {
namespace {

Catalogue catalogue_with_random(const std::string& keys) {
  std::string text = test_support::kCatalogue;
  text.resize(text.find("[[product]]"));
  return parse_catalogue(
      text + "[[random]]\ncount = 400\nframe_count = 90\naircraft = ['c172/*']\n" + keys, "c.toml");
}

std::string error_of(const std::string& keys) {
  return test_support::error_of([&] { catalogue_with_random(keys); });
}

const std::string kApproach =
    "[random.encounter]\ncpa_right_m = [-80, 80]\ncpa_above_m = [-30, 30]\n"
    "course_deg = { any_of = [170, 180, 190] }\nclimb_mps = -1\n";

TEST(DrawnPath, AnApproachIsDrawnFromRangesAndLists) {
  const Catalogue catalogue = catalogue_with_random(kApproach);
  const Expansion expansion(catalogue);
  std::map<double, int> courses;
  int right = 0;
  for (std::int64_t i = 0; i < expansion.size(); ++i) {
    const Item item = expansion.at(i);
    const scene::Intruder& intruder = item.scene.intruders.at(0);
    ASSERT_TRUE(intruder.encounter);
    EXPECT_TRUE(intruder.waypoints_ned_m.empty() && !intruder.speed_mps);
    const scene::Encounter& drawn = *intruder.encounter;
    EXPECT_LE(std::abs(*drawn.cpa_right_m), 80);
    EXPECT_LE(std::abs(drawn.cpa_above_m), 30);
    EXPECT_EQ(drawn.climb_mps, -1);
    // The meeting moment, of a clip of 3 s, and a speed that suits the type.
    EXPECT_GE(drawn.cpa_time_s, 0.2 * 3);
    EXPECT_LE(drawn.cpa_time_s, 0.8 * 3);
    const fleet::FlightLimits& limits = *fleet::flight_limits(intruder.aircraft);
    EXPECT_GE(drawn.speed_mps, limits.usual_low_mps);
    EXPECT_LE(drawn.speed_mps, limits.usual_high_mps);
    ++courses[drawn.course_deg];
    right += *drawn.cpa_right_m > 0 ? 1 : 0;
  }
  // Each of three courses: 400 / 3 with a standard deviation of 9.4; each side: 200 with one of 10.
  ASSERT_EQ(courses.size(), 3u);
  for (const auto& [course_deg, count] : courses) EXPECT_NEAR(count, 400 / 3.0, 4 * 9.4);
  EXPECT_NEAR(right, 200, 40);
}

TEST(DrawnPath, TheDrawnPathHasTheDrawnApproach) {
  const Catalogue catalogue = catalogue_with_random(kApproach + "cpa_time_s = 2\n");
  Item item = Expansion(catalogue).at(7);
  place(item, catalogue, {"sky.mkv", {}, 160, 120, 30, 90});
  const auto own = setup::camera_path(item.scene.camera);
  const auto path = setup::path_of(item.scene.intruders[0], own);
  const Vector3 offset = path.at(2)->position_in_world - own.at(2)->position_in_world;
  const Vector3 velocity = path.at(2)->velocity_in_world_mps - own.at(2)->velocity_in_world_mps;
  EXPECT_NEAR(offset.dot(velocity), 0, 1e-6);
  EXPECT_NEAR(offset.y(), *item.scene.intruders[0].encounter->cpa_right_m, 1e-9);
  EXPECT_EQ(build::plan_of(catalogue, {}, {}).intruders, 400);
}

TEST(DrawnPath, WhatIsSeenIsDrawn) {
  const Catalogue catalogue = catalogue_with_random(
      "[[random.seen]]\ntime_s = [0, 1]\nx_px = [10, 150]\ny_px = { any_of = [20, 40] }\n"
      "range_m = [300, 900]\n[[random.seen]]\ntime_s = 2.5\npixel = [80, 60]\nwidth_px = [5, "
      "50]\n");
  const Expansion expansion(catalogue);
  int small = 0;
  for (std::int64_t i = 0; i < expansion.size(); ++i) {
    const scene::Intruder intruder = expansion.at(i).scene.intruders.at(0);
    ASSERT_EQ(intruder.seen.size(), 2u);
    EXPECT_GE(intruder.seen[0].pixel.x(), 10);
    EXPECT_LT(intruder.seen[0].pixel.x(), 150);
    EXPECT_TRUE(intruder.seen[0].pixel.y() == 20 || intruder.seen[0].pixel.y() == 40);
    EXPECT_LE(*intruder.seen[0].range_m, 900);
    EXPECT_EQ(intruder.seen[1].pixel, Pixel(80, 60));
    small += *intruder.seen[1].width_px < std::sqrt(5 * 50) ? 1 : 0;
  }
  EXPECT_NEAR(small, 200, 40);  // even in the logarithm
  EXPECT_EQ(build::plan_of(catalogue, {}, {}).not_flyable, 0);
}

TEST(DrawnPath, ATrajectoryMayBeAnEncounter) {
  std::string text = test_support::kCatalogue;
  text.replace(
      text.find("waypoints_ned_m"),
      text.find("[[product]]") - text.find("waypoints_ned_m"),
      "encounter = { cpa_time_s = 1, cpa_right_m = 40, course_deg = 180, speed_mps = 50 }\n");
  const Catalogue catalogue = parse_catalogue(text, "c.toml");
  const Item item = Expansion(catalogue).at(0);
  ASSERT_TRUE(item.scene.intruders[0].encounter);
  EXPECT_EQ(item.scene.intruders[0].encounter->cpa_right_m, 40.0);
}

// A camera that hovers is never passed sideways by what crosses before it: the draw is counted.
TEST(DrawnPath, ThePlanCountsDrawsThatNoPathFulfils) {
  const build::Plan plan = build::plan_of(
      catalogue_with_random(
          "[random.encounter]\ncpa_right_m = 50\ncourse_deg = { any_of = [90, 180] }\n"),
      {},
      {});
  EXPECT_NEAR(double(plan.not_flyable), 200, 40);
  ASSERT_FALSE(plan.not_flyable_words.empty());
  EXPECT_NE(plan.not_flyable_words[0].find("no closest approach has this cpa_right_m"),
            std::string::npos);
}

TEST(DrawnPath, SaysWhatIsWrong) {
  EXPECT_NE(error_of("range_m = [1, 2]\n" + kApproach).find("exclude each other"),
            std::string::npos);
  EXPECT_NE(error_of(kApproach + "cpa_ahead_m = 3\n").find("exclude each other"),
            std::string::npos);
  EXPECT_NE(error_of(kApproach + "speed_mps = { of = [1] }\n").find("unknown key 'of'"),
            std::string::npos);
  EXPECT_NE(error_of(kApproach + "speed_mps = [0.5, 60]\n")
                .find("climb_mps reaches 1 at a speed_mps of 0.5"),
            std::string::npos);
  EXPECT_NE(error_of("[[random.seen]]\ntime_s = [0, 2]\npixel = [1, 2]\nrange_m = 9\n"
                     "[[random.seen]]\ntime_s = 2\npixel = [1, 2]\nrange_m = 9\n")
                .find("time_s may be 2, not after the 2"),
            std::string::npos);
  EXPECT_NE(error_of("[[random.seen]]\ntime_s = 2\npixel = [1, 2]\nrange_m = 9\n").find("alone"),
            std::string::npos);
}

}  // namespace
}  // namespace airtruth::catalogue
