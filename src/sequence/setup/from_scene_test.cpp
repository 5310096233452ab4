// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/from_scene.h"

#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace airtruth::setup {
namespace {

struct OwnLog : testing::Test {
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  // Northwards at 1e-4 degrees of latitude a second: 11.1 m/s.
  fs::path csv(const std::string& attitude_columns, const std::string& attitude) const {
    std::string text =
        "time_s,latitude_deg,longitude_deg,altitude_m,height_m" + attitude_columns + "\n";
    for (int i = 0; i <= 30; ++i)
      text +=
          std::to_string(i) + "," + std::to_string(47 + 1e-4 * i) + ",8,500,90" + attitude + "\n";
    return write("log.csv", text);
  }
  // A position a second for 30 s, with attitudes in the first 5.
  fs::path subtitles() const {
    std::string text;
    for (int i = 0; i < 30; ++i)
      text += fmt::format(
          "{}\n00:00:{:02},000 --> 00:00:{:02},500\n[latitude: {}] [longitude: 8.5] "
          "[rel_alt: 90 abs_alt: 500]{}\n\n",
          i + 1,
          i,
          i,
          47 + 1e-4 * i,
          i <= 5 ? " [gb_yaw: 0 gb_pitch: 0 gb_roll: 0]" : "");
    return write("log.srt", text);
  }
  static scene::Scene scene_of(const fs::path& log,
                               const std::string& more,
                               const std::string& motion = "") {
    return scene::parse_scene("[background]\nvideo = \"a.mp4\"\n[lens]\nvertical_fov_deg = 60\n" +
                                  motion + "[camera]\nlog = \"" + log.string() + "\"\n" + more +
                                  "[[intruder]]\naircraft = \"c172/news\"\nwaypoints_ned_m = "
                                  "[[0,0,0],[1,0,0]]\nspeed_mps = 1\n",
                              "s.toml");
  }
  static YawPitchRoll attitude(const trajectory::Path& path, double time_s) {
    return yaw_pitch_roll(path.at(time_s)->world_from_body);
  }
  static std::string error_of(const scene::Scene& scene) {
    return test_support::error_of([&] { camera_path(scene.camera); });
  }
  test_support::TemporaryFolder folder;
};

TEST_F(OwnLog, PositionsAreTheLogsAndTheHeightIsThatAboveTakeOff) {
  const auto path = camera_path(scene_of(csv("", ""), "log_offset_s = 10\n").camera);
  EXPECT_NEAR((path.at(0)->position_in_world - Vector3(0, 0, -90)).norm(), 0, 1e-6);
  EXPECT_NEAR(path.at(10)->position_in_world.x(), 111.2, 0.1);
  EXPECT_NEAR(attitude(path, 0).yaw_deg, 0, 0.01);
  const auto stated = camera_path(
      scene_of(csv("", ""), "log_offset_s = 10\nposition_ned_m = [1, 2, -150]\n").camera);
  EXPECT_NEAR((stated.at(0)->position_in_world - Vector3(1, 2, -150)).norm(), 0, 1e-6);
}

TEST_F(OwnLog, TheAttitudeIsHeldUnlessTheMotionIsSmoothed) {
  const fs::path log = write("turning.csv", [] {
    std::string text = "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg\n";
    for (int i = 0; i <= 30; ++i)
      text += std::to_string(i) + "," + std::to_string(47 + 1e-4 * i) + ",8,500," +
              std::to_string(2 * i) + ",5,1\n";
    return text;
  }());
  const auto held = camera_path(scene_of(log, "log_offset_s = 10\n").camera);
  EXPECT_NEAR(attitude(held, 0).yaw_deg, 20, 1e-6);
  EXPECT_NEAR(attitude(held, 10).yaw_deg, 20, 1e-6);
  EXPECT_NEAR(attitude(held, 10).pitch_deg, 5, 1e-6);
  const auto smoothed = camera_path(
      scene_of(log, "log_offset_s = 10\n", "[motion]\nreference = \"smoothed\"\n").camera);
  EXPECT_NEAR(attitude(smoothed, 10).yaw_deg, 40, 1e-6);
  const auto stated = camera_path(
      scene_of(log, "log_offset_s = 10\nattitude_yaw_pitch_roll_deg = [7, -3, 0]\n").camera);
  EXPECT_NEAR(attitude(stated, 10).yaw_deg, 7, 1e-6);
}

// A stated attitude, and that of a horizon, is the first frame's: from there the camera turns with
// the log.
TEST_F(OwnLog, AStatedAttitudeTurnsWithTheLogUnlessTheMotionDoesSo) {
  // It turns by 3 degrees a second at 20 m/s.
  std::string curve, stated;
  for (int i = 0; i <= 30; ++i) {
    const double turned = radians(3 * i);
    const std::string at =
        fmt::format("{},{:.9f},{:.9f},500",
                    i,
                    47 + degrees(382 * std::sin(turned) / 6368000),
                    8 + degrees(382 * (1 - std::cos(turned)) / (6389000 * std::cos(radians(47)))));
    curve += at + "\n";
    stated += fmt::format("{},{},0,0\n", at, 3 * i);
  }
  const std::string columns = "time_s,latitude_deg,longitude_deg,altitude_m";
  const fs::path logs[] = {write("curve.csv", columns + "\n" + curve),
                           write("stated.csv", columns + ",yaw_deg,pitch_deg,roll_deg\n" + stated)};
  for (const fs::path& log : logs) {
    const std::string camera = "log_offset_s = 10\nattitude_yaw_pitch_roll_deg = [40, -5, 2]\n";
    const auto held = camera_path(scene_of(log, camera).camera);
    EXPECT_NEAR(attitude(held, 10).yaw_deg, 40, 1e-6);
    const auto turning = camera_path(scene_of(log, camera, "[motion]\nmodel = \"none\"\n").camera);
    EXPECT_NEAR(attitude(turning, 0).yaw_deg, 40, 1e-6);
    EXPECT_NEAR(attitude(turning, 10).yaw_deg, 70, 0.2) << log;
    EXPECT_NEAR(attitude(turning, 10).pitch_deg, -5, 0.01) << log;
    EXPECT_NEAR(attitude(turning, 10).roll_deg, 2, 0.01) << log;
  }
}

// East at 10 m/s for 10 s, then a hover in which the last digit of the positions, 0.1 m, toggles.
TEST_F(OwnLog, AHoverHoldsTheHeadingAndSaysSo) {
  std::string text = "time_s,latitude_deg,longitude_deg,altitude_m\n", hover = text;
  unsigned random = 1;
  const auto digit = [&] { return (random = random * 1103515245 + 12345) >> 16 & 1; };
  for (int i = 0; i <= 400; ++i) {
    const double moved_deg = degrees(std::min(i, 100) / (6389000 * std::cos(radians(47))));
    const std::string row = "{:.1f},{:.6f},{:.6f},500\n";
    const double north_deg = 47 + 1e-6 * digit(), east_deg = 8 + 1e-6 * digit();
    text += fmt::format(fmt::runtime(row), 0.1 * i, north_deg, east_deg + moved_deg);
    hover += fmt::format(fmt::runtime(row), 0.1 * i, north_deg, east_deg);
  }
  const fs::path stops = write("stops.csv", text), hovers = write("hovers.csv", hover);
  const std::string offset = "log_offset_s = 15\n", follow = "[motion]\nmodel = \"none\"\n";
  const std::string stated = offset + "attitude_yaw_pitch_roll_deg = [40, -5, 2]\n";
  const auto held_deg = [&](const fs::path& log, const std::string& camera) {
    const scene::Camera own = scene_of(log, camera, follow).camera;
    int warnings = 0;
    warn_of_hover(own, [&](const std::string&) { ++warnings; });
    EXPECT_EQ(warnings, 1);
    const auto path = camera_path(own);
    for (double t = 0; t < 20; t += 0.1)
      EXPECT_NEAR(attitude(path, t).yaw_deg, attitude(path, 0).yaw_deg, 1e-6) << t;
    return attitude(path, 0).yaw_deg;
  };
  // Where it has slowed to 1 m/s, the digit turns the path by some 10 degrees.
  EXPECT_NEAR(held_deg(stops, offset), 90, 30);
  EXPECT_NEAR(held_deg(stops, stated), 40, 1e-6);
  EXPECT_NEAR(held_deg(hovers, offset), 0, 1e-6);
  EXPECT_NEAR(held_deg(hovers, stated), 40, 1e-6);
}

// With columns of angles, and along a curve without: the measured motion turns the camera as well.
TEST_F(OwnLog, AnAttitudeOfAPathFileIsHeldUnlessItIsAllThatTurnsTheCamera) {
  const auto turning = [&](const std::string& file, const std::string& motion) {
    const scene::Scene scene = scene::parse_scene(
        "[background]\nvideo = \"a.mp4\"\n[lens]\nvertical_fov_deg = 60\n[motion]\n" + motion +
            "[camera]\npath_file = \"" + file +
            "\"\n[[intruder]]\naircraft = \"c172/news\"\nwaypoints_ned_m = [[0,0,0],[1,0,0]]\n"
            "speed_mps = 1\n",
        (folder / "s.toml").string());
    const auto path = camera_path(scene.camera);
    return attitude(path, 10).yaw_deg - attitude(path, 0).yaw_deg;
  };
  std::string stated = "time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg\n";
  std::string curve = "time_s,north_m,east_m,down_m\n";
  for (int i = 0; i <= 10; ++i) {
    stated += fmt::format("{},{},0,-100,{},2,1\n", i, 20 * i, 3 * i);
    const double turned = radians(3 * i);
    curve +=
        fmt::format("{},{},{},-100\n", i, 400 * std::sin(turned), 400 - 400 * std::cos(turned));
  }
  write("stated.csv", stated);
  write("curve.csv", curve);
  for (const char* file : {"stated.csv", "curve.csv"}) {
    EXPECT_NEAR(turning(file, ""), 0, 1e-6) << file;
    // The ends of a natural spline are straight.
    EXPECT_NEAR(turning(file, "reference = \"smoothed\"\n"), 30, 2) << file;
    EXPECT_NEAR(turning(file, "model = \"none\"\n"), 30, 2) << file;
  }
}

// A log of 30 s without records from 10 to 15 s.
TEST_F(OwnLog, AGapOverWhichTheClipLiesIsWarnedOf) {
  std::string text =
      "time_s,latitude_deg,longitude_deg,altitude_m,height_m,yaw_deg,pitch_deg,roll_deg\n";
  for (int i = 0; i <= 30; ++i)
    if (i <= 10 || i >= 15) text += fmt::format("{},{},8,500,90,0,0,0\n", i, 47 + 1e-4 * i);
  const fs::path log = write("gap.csv", text);
  const auto warnings = [&](const std::string& camera, double clip_s, const std::string& motion) {
    std::vector<std::string> said;
    warn_of_gaps(scene_of(log, camera, motion).camera, clip_s, [&](const std::string& words) {
      said.push_back(words);
    });
    return said;
  };
  const std::string followed = "[motion]\nmodel = \"none\"\n";
  EXPECT_THAT(warnings("log_offset_s = 8\n", 3, followed),
              testing::ElementsAre(
                  log.string() +
                      ": the clip of about 3.0 s lies over a gap in the log's positions (the "
                      "longest from 10.00 "
                      "to 15.00 s "
                      "of the log, 2.00 to 7.00 s of the clip), across which they are interpolated",
                  testing::HasSubstr("attitudes")));
  // Of the attitudes the first frame's alone is used, or none.
  EXPECT_EQ(warnings("log_offset_s = 8\n", 3, "").size(), 1u);
  EXPECT_EQ(warnings("log_offset_s = 12\n", 3, "").size(), 2u);
  const std::string stated = "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n";
  EXPECT_EQ(warnings("log_offset_s = 12\n" + stated, 3, "").size(), 1u);
  EXPECT_TRUE(warnings("log_offset_s = 1\n", 8, followed).empty());
  EXPECT_TRUE(warnings("log_offset_s = 16\n", 8, followed).empty());
}

// What no attitude of the log turns is not bound to where they end.
TEST_F(OwnLog, AttitudesMustCoverWhatTheyTurn) {
  const auto scene = [&](const std::string& more, const std::string& motion) {
    return scene_of(subtitles(), "log_offset_s = 2\n" + more, motion);
  };
  const std::string followed = "[motion]\nmodel = \"none\"\n";
  const std::string stated = "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n";
  EXPECT_NEAR(camera_path(scene("", followed).camera).end_s(), 4.5, 1e-6);
  EXPECT_NEAR(camera_path(scene("", "").camera).end_s(), 28.5, 1e-6);
  EXPECT_NEAR(camera_path(scene(stated, "").camera).end_s(), 28.5, 1e-6);
}

TEST_F(OwnLog, ASceneWithALogIsWrittenAndReadTheSame) {
  const auto scene = scene_of(csv("", ""), "log_offset_s = 10.25\nposition_ned_m = [1, 2, -150]\n");
  const auto again = scene::parse_scene(scene::toml_from_scene(scene), "again.toml");
  EXPECT_EQ(again.camera.log, scene.camera.log);
  EXPECT_EQ(again.camera.log_offset_s, 10.25);
  EXPECT_TRUE(again.camera.position_is_stated);
  EXPECT_FALSE(again.camera.attitude_yaw_pitch_roll_deg.has_value());
}

TEST_F(OwnLog, WhatDoesNotFitIsAnErrorAtTheScenesLine) {
  EXPECT_EQ(error_of(scene_of(csv(",yaw_deg,pitch_deg,roll_deg", ",90,1,2"), "")),
            "s.toml:5:1: the log (CSV) has a clock of its own; expected log_offset_s, which "
            "'airtruth log align' finds");
  const fs::path log = csv("", "");
  EXPECT_EQ(
      error_of(scene_of(log, "")),
      "s.toml:5:1: the log (CSV) has a clock of its own; expected log_offset_s, its time at the "
      "first frame that the scene uses");
  EXPECT_EQ(
      error_of(scene_of(log, "log_offset_s = 100\n")),
      "s.toml:5:1: the log's positions go from 0.00 to 30.00 s, and the clip begins at 100.000 "
      "s of the log; "
      "expected a log of the same flight, or another log_offset_s");
  EXPECT_THAT(error_of(scene_of(folder / "missing.csv", "log_offset_s = 1\n")),
              testing::HasSubstr("missing.csv"));
  const auto parse_error = [&](const std::string& camera, const std::string& background) {
    return test_support::error_of([&] {
      scene::parse_scene("[background]\nvideo = \"a.mp4\"\n" + background +
                             "[lens]\nvertical_fov_deg = 60\n[camera]\n" + camera +
                             "[[intruder]]\naircraft = \"c172/news\"\nwaypoints_ned_m = "
                             "[[0,0,0],[1,0,0]]\nspeed_mps = 1\n",
                         "s.toml");
    });
  };
  EXPECT_THAT(parse_error("log_offset_s = 1\n", ""),
              testing::HasSubstr("log_offset_s is stated without a log"));
  EXPECT_THAT(parse_error("log = \"a.srt\"\npath_file = \"a.csv\"\n", ""),
              testing::HasSubstr("path_file"));
}

TEST(Multirotor, LeansByItsSpeedOverTheGround) {
  const auto pitch_deg = [](const std::string& path) {
    const scene::Scene scene = scene::parse_scene(
        "[background]\nvideo = \"a.mp4\"\n[lens]\nvertical_fov_deg = 60\n"
        "[camera]\nposition_ned_m = [0, 0, -100]\nvelocity_ned_mps = [20, 0, 0]\n"
        "[[distractor]]\nkind = \"multirotor\"\nsize_m = 0.8\n" +
            path,
        "s.toml");
    const auto flown = path_of(scene.intruders.at(0), camera_path(scene.camera));
    return yaw_pitch_roll(flown.at(1)->world_from_body).pitch_deg;
  };
  const std::string place = "position_ned_m = [60, 0, -100]\nvelocity_ned_mps = ";
  EXPECT_NEAR(pitch_deg(place + "[0, 0, -9]\n"), 0, 1e-6);
  EXPECT_NEAR(pitch_deg(place + "[0, 5, -9]\n"), -8, 1e-6);
  const std::string up = "waypoints_ned_m = [[60, 0, -100], [60, 0, -136]]\n";
  EXPECT_NEAR(pitch_deg(up + "speed_mps = 9\n"), 0, 1e-6);
  EXPECT_NEAR(pitch_deg(up + "times_s = [0, 4]\n"), 0, 1e-6);
  const std::string slope = "waypoints_ned_m = [[60, 0, -100], [60, 30, -140]]\n";
  EXPECT_NEAR(pitch_deg(slope + "speed_mps = 10\n"), -1.6 * 6, 1e-6);
  EXPECT_NEAR(pitch_deg(slope + "times_s = [0, 5]\n"), -1.6 * 6, 1e-6);
  EXPECT_NEAR(pitch_deg("encounter = { cpa_time_s = 2, cpa_right_m = 0, cpa_above_m = 10, "
                        "course_deg = 90, speed_mps = 10, climb_mps = 8 }\n"),
              -1.6 * 6,
              1e-6);
}

// Eastwards at 10 m/s.
TEST(Multirotor, TakesTheAnglesOfAPathFileAndLeansByItsSpeedWhereThereAreNone) {
  const test_support::TemporaryFolder folder;
  const auto angles = [&](const std::string& columns,
                          const std::string& values,
                          const std::string& kind,
                          const std::string& more = "") {
    std::ofstream(folder / "p.csv") << "time_s,north_m,east_m,down_m" + columns + "\n0,60,0,-100" +
                                           values + "\n3,60,30,-100" + values + "\n";
    const scene::Scene scene = scene::parse_scene(
        "[background]\nvideo = \"a.mp4\"\n[lens]\nvertical_fov_deg = 60\n[camera]\nposition_ned_m "
        "= "
        "[0, 0, -100]\nvelocity_ned_mps = [0, 0, 0]\n[[distractor]]\nkind = \"" +
            kind + "\"\npath_file = \"" + (folder / "p.csv").string() + "\"\n" + more,
        "s.toml");
    const auto flown = path_of(scene.intruders.at(0), camera_path(scene.camera));
    return vector_of(numbers_of(yaw_pitch_roll(flown.at(1)->world_from_body)));
  };
  const auto is = [](const Vector3& found, const Vector3& expected) {
    return (found - expected).norm() < 1e-6;
  };
  const std::string all = ",yaw_deg,pitch_deg,roll_deg", some = ",pitch_deg,roll_deg";
  EXPECT_TRUE(is(angles("", "", "multirotor"), {90, -16, 0}));
  EXPECT_TRUE(is(angles("", "", "balloon"), {90, 0, 0}));
  EXPECT_TRUE(is(angles(all, ",80,-20,15", "multirotor"), {80, -20, 15}));
  EXPECT_TRUE(is(angles(all, ",80,-20,15", "balloon"), {80, -20, 15}));
  EXPECT_TRUE(is(angles(some, ",0,30", "multirotor", "yaw_deg = 10\n"), {10, 0, 30}));
  EXPECT_TRUE(is(angles(some, ",-20,15", "multirotor", "pitch_deg = 5\n"), {90, 5, 15}));
}

}  // namespace
}  // namespace airtruth::setup
