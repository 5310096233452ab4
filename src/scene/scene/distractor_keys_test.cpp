// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "labels/annotation/object_class.h"
#include "scene/scene/flock.h"
#include "scene/scene/scene.h"
#include "support/error_of.h"

namespace airtruth::scene {
namespace {

const std::string kHead =
    "[background]\nvideo = \"clip.mp4\"\n[lens]\nvertical_fov_deg = 60\n[[distractor]]\n";
const std::string kDistractorPath =
    "waypoints_ned_m = [[100, -10, -150], [100, 10, -150]]\nspeed_mps = 12\n";

Scene scene_with(const std::string& keys) { return parse_scene(kHead + keys, "/data/s.toml"); }

std::string message_with_keys(const std::string& keys) {
  try {
    scene_with(keys);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(DistractorKeys, KindsAreTheClassesOfTheTruth) {
  std::set<std::string> words;
  for (const auto& [kind, word] : enum_names(DistractorKind{})) {
    words.insert(word);
    EXPECT_TRUE(annotation::is_object_class(word));
    EXPECT_EQ(annotation::is_on_lens(word), is_on_lens(kind)) << word;
  }
  EXPECT_EQ(words.size(), annotation::kInTheAir.size() + annotation::kOnTheLens.size());
}

TEST(DistractorKeys, ABirdFollowsAPathAndBeatsAsItsSizeHasIt) {
  const Scene scene =
      scene_with("kind = \"bird\"\nsize_m = 0.65\nplumage = \"grey\"\n" + kDistractorPath);
  ASSERT_EQ(scene.intruders.size(), 1U);
  const Intruder& bird = scene.intruders[0];
  EXPECT_EQ(bird.id, "bird-1");
  EXPECT_EQ(bird.aircraft, "bird");
  ASSERT_TRUE(bird.distractor);
  EXPECT_FALSE(is_aircraft(bird));
  EXPECT_EQ(bird.distractor->size_m, 0.65);
  EXPECT_EQ(bird.distractor->plumage, shapes::Plumage::kGrey);
  EXPECT_NEAR(bird.distractor->flap_hz, 3.05 * std::sqrt(1.34 / 0.65), 1e-12);
  EXPECT_EQ(bird.speed_mps, 12.0);
}

TEST(DistractorKeys, AircraftComeFirst) {
  const Scene scene = scene_with(
      "kind = \"balloon\"\nposition_ned_m = [50, 0, -150]\n[[intruder]]\naircraft = "
      "\"c172/news\"\n" +
      kDistractorPath);
  ASSERT_EQ(scene.intruders.size(), 2U);
  EXPECT_TRUE(is_aircraft(scene.intruders[0]));
  EXPECT_EQ(scene.intruders[1].aircraft, "balloon");
  EXPECT_EQ(*scene.intruders[1].position_ned_m, Vector3(50, 0, -150));
}

TEST(DistractorKeys, AFlockIsItsBirdsApartFromEachOther) {
  const Scene scene =
      scene_with("kind = \"bird\"\nid = \"starlings\"\nsize_m = 0.4\ncount = 20\nspread_m = 8\n" +
                 kDistractorPath);
  ASSERT_EQ(scene.intruders.size(), 20U);
  EXPECT_EQ(scene.intruders[19].id, "starlings-20");
  std::set<double> phases;
  for (const Intruder& one : scene.intruders) {
    phases.insert(one.distractor->flap_phase);
    EXPECT_LE(one.offset_ned_m.head<2>().norm(), 8);
    EXPECT_LE(std::abs(one.offset_ned_m.z()), 8.0 / 3);
    EXPECT_NEAR(one.distractor->size_m, 0.4, 0.04);
    for (const Intruder& other : scene.intruders) {
      if (&other == &one) continue;
      EXPECT_GT((one.offset_ned_m - other.offset_ned_m).norm(), 1.8 * one.distractor->size_m);
    }
  }
  EXPECT_EQ(phases.size(), 20U);
}

TEST(DistractorKeys, TheEffectiveSceneReadsBackAsItIs) {
  for (const std::string& keys :
       {"kind = \"bird\"\ncount = 3\nspread_m = 4\n" + kDistractorPath,
        "kind = \"bird\"\ncount = 20\nspread_m = 4\nsize_m = 0.05\n" + kDistractorPath,
        "kind = \"bird\"\ncount = 20\nspread_m = 4\nsize_m = 20\nflap_hz = 98\n" + kDistractorPath,
        std::string("kind = \"multirotor\"\nrotors = 6\ncolour = [0.1, 0.2, 0.3]\narm_colour = "
                    "[0.4, 0, 0]\nposition_ned_m = "
                    "[60, 1, -150]\nvelocity_ned_mps = [3, 0, 0]\nyaw_deg = 10\n"),
        std::string("kind = \"balloon\"\n[distractor.encounter]\ncpa_time_s = 2\ncourse_deg = "
                    "90\nspeed_mps = 4\ncpa_right_m = 20\n"),
        std::string("kind = \"dirt\"\npixel = [100, 50]\n[[distractor]]\nkind = \"glint\"\n"
                    "[[distractor]]\nkind = \"insect\"\npixel = [0, 200]\nbegin_s = 1.5\n")}) {
    const Scene scene = scene_with(keys);
    const std::string text = toml_from_scene(scene);
    const Scene again = parse_scene(text, "/elsewhere/t.toml");
    EXPECT_EQ(toml_from_scene(again), text) << text;
    ASSERT_EQ(again.intruders.size(), scene.intruders.size());
    for (std::size_t i = 0; i < scene.intruders.size(); ++i) {
      EXPECT_EQ(again.intruders[i].distractor, scene.intruders[i].distractor);
      EXPECT_EQ(again.intruders[i].offset_ned_m, scene.intruders[i].offset_ned_m);
    }
    ASSERT_EQ(again.lens_marks.size(), scene.lens_marks.size());
    for (std::size_t i = 0; i < scene.lens_marks.size(); ++i) {
      EXPECT_EQ(again.lens_marks[i].size_px, scene.lens_marks[i].size_px);
      EXPECT_EQ(again.lens_marks[i].end_s, scene.lens_marks[i].end_s);
    }
  }
}

TEST(DistractorKeys, WrongKeysAreNamedAtTheirLine) {
  EXPECT_EQ(message_with_keys("size_m = 1\n"),
            "/data/s.toml:5:1: [[distractor]] has no kind; expected bird, multirotor, balloon, "
            "glint, dirt or insect");
  EXPECT_NE(message_with_keys("kind = \"brid\"\n").find("did you mean 'bird'?"), std::string::npos);
  EXPECT_EQ(message_with_keys("kind = \"balloon\"\nglide = 0.5\n" + kDistractorPath),
            "/data/s.toml:7:9: glide has no effect with kind = \"balloon\"");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\nopacity = 0.5\n" + kDistractorPath),
            "/data/s.toml:7:11: opacity has no effect with kind = \"bird\"");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\ncolour = [0, 0, 0]\n" + kDistractorPath),
            "/data/s.toml:7:10: colour has no effect with kind = \"bird\"");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\ncount = 4\n" + kDistractorPath),
            "/data/s.toml:7:9: count is 4 without spread_m; expected the flock's radius in metres "
            "with it");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\ncount = 2\nspread_m = 4\nid = \"" +
                              std::string(199, 'b') + "\"\n" + kDistractorPath),
            "/data/s.toml:9:6: id is too long for a flock, whose members are ID-1, ID-2, ...; "
            "expected a shorter one");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\nspread_m = 4\n" + kDistractorPath),
            "/data/s.toml:7:12: spread_m has no effect without a count");
  EXPECT_EQ(message_with_keys("kind = \"dirt\"\npixel = [9, 9]\narm_colour = [0, 0, 0]\n"),
            "/data/s.toml:8:14: arm_colour has no effect with kind = \"dirt\"");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\nsize_m = nan\n" + kDistractorPath)
                .find("/data/s.toml:7:10: "),
            0U);
  EXPECT_EQ(message_with_keys("kind = \"multirotor\"\nrotors = 5\n" + kDistractorPath),
            "/data/s.toml:7:10: rotors is 5; expected 4, 6 or 8");
  EXPECT_EQ(message_with_keys("kind = \"balloon\"\narm_colour = [0, 0, 0]\n" + kDistractorPath),
            "/data/s.toml:7:14: arm_colour has no effect with kind = \"balloon\"");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\n"),
            "/data/s.toml:5:1: [[distractor]] has no path; expected waypoints_ned_m with speed_mps "
            "or times_s, path_file, encounter or seen");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\n[distractor.encounter]\ncpa_time_s = 4\n"),
            "/data/s.toml:7:1: [encounter] has no course_deg; expected the course from the own "
            "course: 180 head-on, 90 from the left");
  EXPECT_EQ(message_with_keys("kind = \"dirt\"\n"),
            "/data/s.toml:5:1: [[distractor]] of kind \"dirt\" has no pixel; expected the place of "
            "its middle in the picture");
  EXPECT_EQ(message_with_keys("kind = \"dirt\"\npixel = [1, 2]\nsize_px = 50\nlength_px = 20\n"),
            "/data/s.toml:9:13: length_px is 20, below size_px; expected 50 or more");
  EXPECT_EQ(message_with_keys("kind = \"bird\"\nposition_ned_m = [1, 2, 3]\n" + kDistractorPath),
            "/data/s.toml:8:19: position_ned_m and waypoints_ned_m exclude each other; keep one of "
            "them");
  EXPECT_EQ(message_with_keys("kind = \"dirt\"\nid = \"a\"\npixel = [1, 2]\n[[distractor]]\nkind = "
                              "\"dirt\"\nid = \"a\"\npixel = [3, 4]\n"),
            "/data/s.toml:11:6: id 'a' is taken; expected another");
}

// A thousand things are a scene, one more is a line; birds of flocks count one by one.
TEST(DistractorKeys, AThousandThingsAreTheMost) {
  const std::string head = "[background]\nvideo = \"a.mp4\"\n[lens]\nvertical_fov_deg = 60\n";
  const auto flock = [](int count) {
    return "[[distractor]]\nkind = \"bird\"\nspread_m = 900\nposition_ned_m = [9, 0, 0]\ncount = " +
           std::to_string(count) + "\n";
  };
  std::string most = head;
  for (int i = 0; i < 5; ++i) most += flock(200);
  EXPECT_EQ(parse_scene(most, "s.toml").intruders.size(), 1000u);
  const auto error = [](const std::string& text) -> std::string {
    return test_support::error_of([&] { parse_scene(text, "s.toml"); });
  };
  EXPECT_THAT(error(most + "[[distractor]]\nkind = \"dirt\"\npixel = [1, 1]\n"),
              testing::HasSubstr("beyond the 1000 intruders and distractors"));
  EXPECT_THAT(
      error(head + flock(200) + flock(200) + flock(200) + flock(200) + flock(199) + flock(2)),
      testing::HasSubstr("count is 2, with which the scene has more than 1000"));
  std::string intruders = head;
  for (int i = 0; i < 1001; ++i)
    intruders +=
        "[[intruder]]\naircraft = \"c172/news\"\nwaypoints_ned_m = [[1, 0, 0], [2, 0, "
        "0]]\nspeed_mps = 9\n";
  EXPECT_THAT(error(intruders), testing::HasSubstr("has 1001 tables [[intruder]]"));
}

}  // namespace
}  // namespace airtruth::scene
