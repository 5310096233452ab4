// SPDX-License-Identifier: Apache-2.0
#include "dataset/catalogue/drawn_rule.h"

#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <variant>

#include <gtest/gtest.h>

#include "aircraft/fleet/flight_limits.h"
#include "dataset/build/plan.h"
#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "scene/scene/table_reader.h"
#include "sequence/setup/from_scene.h"
#include "support/error_of.h"
#include "support/small_catalogue.h"
#include "support/small_encounter_model.h"
#include "support/source_folder.h"
#include "support/temporary_folder.h"

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

// Every number of the rules, but those of tables that a scene has as well.
const std::string kEveryNumber = R"(
[stream]
size_px = [64, 64]
[[background]]
name = "sky"
flight = { frame_count = 2 }
lens = { vertical_fov_deg = 60 }
[[trajectory]]
name = "a"
waypoints_ned_m = [[60, 0, -150], [60, 20, -150]]
speed_mps = 20
[[aircraft]]
name = "b"
aircraft = "c172/news"
[[sequence]]
name = "one"
background = "sky"
trajectory = "a"
aircraft = "b"
[[product]]
[[random]]
aircraft = ["c172/*"]
range_m = [1, 2]
azimuth_deg = [1, 2]
elevation_deg = [1, 2]
heading_deg = [1, 2]
speed_mps = [1, 2]
climb_deg = [1, 2]
bank_deg = [1, 2]
intruders = 1
sun_azimuth_deg = [1, 2]
sun_elevation_deg = [1, 2]
[[random]]
name = "s{index}"
aircraft = ["c172/*"]
size_px = [1, 2]
time_of_day_h = [10, 12]
[[encounter_model]]
kind = "geometric"
aircraft = ["c172/*"]
hmd_m = [0, 9]
hmd_shares = [1]
vmd_m = [0, 9]
vmd_shares = [1]
course_deg = 180
speed_mps = 50
climb_mps = 0
turn_rate_dps = 0
[[encounter_model]]
name = "m{index}"
kind = "bayes"
model = "small.txt"
aircraft = ["c172/*"]
[[distractor]]
kind = "bird"
size_m = [1, 2]
range_m = [1, 2]
azimuth_deg = [1, 2]
elevation_deg = [1, 2]
heading_deg = [1, 2]
climb_deg = [1, 2]
speed_mps = [1, 2]
count = 1
flock = 1
spread_m = [1, 2]
glide = [0, 1]
[[distractor]]
kind = "insect"
spot_px = [1, 2]
opacity = [0.1, 0.2]
speed_px_s = [1, 2]
)";

TEST(CatalogueRanges, StandInTheTablesOfThePage) {
  using Bounds = std::pair<double, double>;
  std::map<std::string, std::set<Bounds>> stated;  // by the keys of the same row
  std::istringstream page(read_file(test_support::source_folder() / "docs/formats/catalogue.md"));
  const std::regex name("`(\\w+)"), range("(-?[0-9.]+(?:e[0-9]+)?) to (-?[0-9.]+(?:e[0-9]+)?)");
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with('|')) continue;
    for (std::sregex_iterator key(line.begin(), line.end(), name), end; key != end; ++key)
      for (std::sregex_iterator one(line.begin(), line.end(), range); one != end; ++one)
        stated[(*key)[1]].emplace(std::stod((*one)[1]), std::stod((*one)[2]));
  }
  const test_support::TemporaryFolder folder;
  write_file(folder.path() / "small.txt", test_support::kSmallModel);
  std::map<std::string, Bounds> read;
  scene::call_on_key_use([&](const std::string& path, const scene::KeyUse& use) {
    if (const auto* number = std::get_if<scene::NumberKey>(&use))
      read[path] = {number->limits[0].low, number->limits[0].high};
    if (const auto* whole = std::get_if<scene::WholeKey>(&use))
      read[path] = {static_cast<double>(whole->low), static_cast<double>(whole->high)};
  });
  const std::string error =
      test_support::error_of([&] { parse_catalogue(kEveryNumber, folder.path() / "c.toml"); });
  scene::call_on_key_use({});
  ASSERT_EQ(error, "no error");
  const std::regex of_a_rule(
      "(random|encounter_model|distractor|sequence|product)\\[\\d\\]\\.\\w+|stream\\.\\w+|"
      "background\\[0\\]\\.(flight\\.(?!seed)\\w+|weight|first_frame|frame_count)");
  int seen = 0;
  for (const auto& [path, bounds] : read) {
    const std::string key = path.substr(path.rfind('.') + 1);
    if (!std::regex_match(path, of_a_rule) || key == "cpa_time_s") continue;  // within the clip
    ++seen;
    EXPECT_TRUE(stated[key].contains(bounds))
        << path << ": " << bounds.first << " to " << bounds.second;
  }
  EXPECT_GT(seen, 60);
}

}  // namespace
}  // namespace airtruth::catalogue
