// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "scene/scene/scene.h"
#include "support/error_of.h"

namespace airtruth::scene {
namespace {

std::string encounter_scene_text(const std::string& path) {
  return "[background]\nvideo = 'flight.mp4'\n[lens]\nvertical_fov_deg = 90\n[[intruder]]\n"
         "aircraft = 'c172/news'\n" +
         path;
}

Intruder intruder_with(const std::string& path) {
  return parse_scene(encounter_scene_text(path), "s.toml").intruders.at(0);
}

std::string encounter_message_of(const std::string& path) {
  return test_support::error_of([&] { parse_scene(encounter_scene_text(path), "s.toml"); });
}

const std::string kEncounter =
    "[intruder.encounter]\ncpa_time_s = 8\ncourse_deg = 180\nspeed_mps = 62\n";
const std::string kSeen =
    "[[intruder.seen]]\ntime_s = 0\npixel = [210, 160.5]\nrange_m = 800\n"
    "[[intruder.seen]]\ntime_s = 6\npixel = [600, -20]\nwidth_px = 14\n";

TEST(EncounterKeys, AnEncounterArrives) {
  const Intruder intruder = intruder_with(
      kEncounter + "cpa_right_m = 60\ncpa_above_m = 15\nclimb_mps = -1.5\nturn_rate_dps = 2\n");
  ASSERT_TRUE(intruder.encounter);
  EXPECT_EQ(intruder.encounter->cpa_time_s, 8);
  EXPECT_EQ(intruder.encounter->cpa_right_m, 60.0);
  EXPECT_EQ(intruder.encounter->cpa_above_m, 15);
  EXPECT_FALSE(intruder.encounter->cpa_ahead_m);
  EXPECT_EQ(intruder.encounter->course_deg, 180);
  EXPECT_EQ(intruder.encounter->speed_mps, 62);
  EXPECT_EQ(intruder.encounter->climb_mps, -1.5);
  EXPECT_EQ(intruder.encounter->turn_rate_dps, 2);
  EXPECT_EQ(to_string(intruder.encounter->where), "s.toml:7:1");
}

TEST(EncounterKeys, WhatIsSeenArrives) {
  const Intruder intruder = intruder_with(kSeen);
  ASSERT_EQ(intruder.seen.size(), 2u);
  EXPECT_EQ(intruder.seen[0].pixel, Pixel(210, 160.5));
  EXPECT_EQ(intruder.seen[0].range_m, 800.0);
  EXPECT_FALSE(intruder.seen[0].width_px);
  EXPECT_EQ(intruder.seen[1].time_s, 6);
  EXPECT_EQ(intruder.seen[1].width_px, 14.0);
}

TEST(EncounterKeys, TheEffectiveSceneReadsBackTheSame) {
  for (const std::string& path : {"roll_deg = 3\n" + kEncounter + "cpa_ahead_m = -7.25\n", kSeen}) {
    const Scene scene = parse_scene(encounter_scene_text(path), "/data/s.toml");
    const std::string text = toml_from_scene(scene);
    const Scene again = parse_scene(text, "/elsewhere/t.toml");
    EXPECT_EQ(toml_from_scene(again), text);
    EXPECT_EQ(again.intruders[0].roll_deg, scene.intruders[0].roll_deg);
    ASSERT_EQ(again.intruders[0].seen.size(), scene.intruders[0].seen.size());
    ASSERT_EQ(again.intruders[0].encounter.has_value(), scene.intruders[0].encounter.has_value());
    if (scene.intruders[0].encounter) {
      EXPECT_EQ(again.intruders[0].encounter->cpa_ahead_m, -7.25);
    }
  }
}

TEST(EncounterKeys, APathIsGivenOnce) {
  const std::string waypoints = "waypoints_ned_m = [[1, 2, 3], [4, 5, 6]]\n";
  EXPECT_EQ(encounter_message_of(waypoints + "speed_mps = 3\n" + kEncounter),
            "s.toml:7:19: encounter and waypoints_ned_m exclude each other; keep one of them");
  EXPECT_EQ(encounter_message_of("start_s = 2\n" + kSeen),
            "s.toml:7:11: seen and start_s exclude each other; keep one of them");
  EXPECT_NE(encounter_message_of(kEncounter + kSeen).find("encounter and seen exclude each other"),
            std::string::npos);
}

TEST(EncounterKeys, WhatIsMissingIsNamed) {
  EXPECT_EQ(encounter_message_of("[intruder.encounter]\ncourse_deg = 180\nspeed_mps = 62\n"),
            "s.toml:7:1: [encounter] has no cpa_time_s; expected the time of the closest "
            "approach, in seconds");
  EXPECT_EQ(encounter_message_of("[[intruder.seen]]\ntime_s = 1\nrange_m = 9\n"),
            "s.toml:7:1: [[seen]] has no pixel; expected time_s, pixel = [x, y], and "
            "range_m or width_px");
  EXPECT_EQ(encounter_message_of("[[intruder.seen]]\ntime_s = 1\npixel = [1, 2]\n"),
            "s.toml:7:1: [[seen]] has no range_m and no width_px; expected one of them");
  EXPECT_EQ(encounter_message_of("[[intruder.seen]]\ntime_s = 1\npixel = [1, 2]\nrange_m = 9\n"),
            "s.toml:7:1: [[seen]] is alone; expected at least two of them");
}

TEST(EncounterKeys, WhatCannotBeIsAnError) {
  EXPECT_EQ(encounter_message_of(kEncounter + "climb_mps = -63\n"),
            "s.toml:11:13: climb_mps is -63 at a speed_mps of 62; expected no more than the speed");
  std::string twice = kSeen;
  twice.replace(twice.find("time_s = 6"), 10, "time_s = 0");
  EXPECT_EQ(encounter_message_of(twice),
            "s.toml:12:10: time_s is 0, not after the 0 of the [[seen]] before; expected "
            "increasing times");
  EXPECT_NE(encounter_message_of(kSeen + "range_m = 3\n").find("exclude each other"),
            std::string::npos);
  EXPECT_NE(encounter_message_of(kEncounter + "turn_rate_dps = inf\n").find("turn_rate_dps"),
            std::string::npos);
}

}  // namespace
}  // namespace airtruth::scene
