// SPDX-License-Identifier: Apache-2.0
#include "sequence/preview/preview.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "labels/annotation/truth.h"
#include "sequence/demo/demo.h"
#include "sequence/pipeline/render.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/preview/rows.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"
#include "support/ffmpeg.h"
#include "support/flight_file.h"
#include "support/temporary_folder.h"

namespace airtruth::preview {
namespace {

TEST(PreviewRows, ALongClipHasNoMoreThanSixtyTimes) {
  EXPECT_THAT(whole_seconds(3.5), testing::ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(whole_seconds(0.2), testing::ElementsAre(0));
  EXPECT_LE(whole_seconds(3600).size(), 60u);
  EXPECT_DOUBLE_EQ(whole_seconds(3600)[1], std::round(whole_seconds(3600)[1]));
}

// The own aircraft flies north at 25 m/s; the intruder comes from ahead at 50 m/s, 20 m to the
// right and 10 m higher, and passes after 4 s.
scene::Scene head_on(const fs::path& video) {
  return scene::parse_scene(
      "[background]\nvideo = \"" + video.string() +
          "\"\n[lens]\nvertical_fov_deg = 60\n[camera]\nposition_ned_m = [0, 0, -150]\n"
          "velocity_ned_mps = [25, 0, 0]\n"
          "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n[[intruder]]\nid = \"near\"\naircraft = "
          "\"c172/g-boix\"\n"
          "[intruder.encounter]\ncpa_time_s = 4\ncpa_right_m = 20\ncpa_above_m = 10\ncourse_deg = "
          "180\n"
          "speed_mps = 50\n",
      "head-on.toml");
}

TEST(PreviewRows, NumbersAreThoseOfAHeadOnEncounter) {
  const scene::Scene scene = head_on("none.mp4");
  const setup::World world = setup::load_world(scene, {640, 480}, {});
  const auto parties = parties_of(scene);
  const auto rows = preview_rows(world, parties, whole_seconds(5), [&](double time_s) {
    return setup::moment_at(world, std::llround(30 * time_s), time_s, {});
  });
  ASSERT_EQ(rows.size(), 6u);
  const double focal_px = 240 / std::tan(radians(30));
  EXPECT_NEAR(rows[0].nearest.range_m, std::sqrt(300.0 * 300 + 20 * 20 + 10 * 10), 1e-6);
  EXPECT_NEAR(rows[0].nearest.relative_bearing_deg.value(), degrees(std::atan2(20, 300)), 1e-6);
  EXPECT_NEAR(rows[0].nearest.tcpa_s.value(), 4, 1e-6);
  EXPECT_NEAR(rows[0].nearest.above_m, 10, 1e-9);
  ASSERT_TRUE(rows[0].box_px);
  EXPECT_NEAR(rows[0].box_px->x + rows[0].box_px->width / 2, 320 + focal_px * 20 / 300, 1);
  // 11 m of span.
  EXPECT_NEAR(rows[0].box_px->width, focal_px * 11 / 300, 1);
  EXPECT_FALSE(rows[4].box_px);          // abeam
  EXPECT_FALSE(rows[5].nearest.tcpa_s);  // diverging
  const auto lines = approach_lines(world, parties, {0}, 5);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], testing::HasSubstr("near: closest 22.4 m at 4.00 s"));
  EXPECT_THAT(table_text(rows), testing::HasSubstr("out of view"));
}

// Both reach behind the camera's plane, where a box has no bounds: one beside the camera, and one
// in whose tail the camera is.
TEST(PreviewRows, WhatReachesBehindTheCameraHasItsPlaceAlone) {
  const auto beside = [](const std::string& place) {
    return "[[intruder]]\naircraft = \"c172/g-boix\"\nwaypoints_ned_m = [[" + place +
           ", -150], [1000, 0, -150]]\nspeed_mps = 50\n";
  };
  const scene::Scene scene = scene::parse_scene(
      "[background]\nvideo = \"none.mp4\"\n[lens]\nvertical_fov_deg = 60\n"
      "[camera]\nposition_ned_m = [0, 0, -150]\n"
      "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n" +
          beside("0, 20") + beside("2, 0"),
      "beside.toml");
  const setup::World world = setup::load_world(scene, {640, 480}, {});
  const setup::Moment moment = setup::moment_at(world, 0, 0, {});
  for (const auto& exact : moment.boxes) EXPECT_TRUE(exact.box && exact.partly_unseen);
  const auto rows = preview_rows(world, parties_of(scene), {0}, [&](double) { return moment; });
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_FALSE(rows[0].box_px);
  ASSERT_TRUE(rows[1].box_px);
  EXPECT_NEAR(rows[1].box_px->x, 320, 1);
  EXPECT_EQ(rows[1].box_px->width, 0);
  EXPECT_EQ(table_cells(rows[1])[4], "-");
}

// Two flocks side by side and a lone bird: a row for each, around all of its members.
TEST(PreviewRows, AFlockIsOneRow) {
  const auto flock = [](int east_m, int count) {
    return "[[distractor]]\nkind = \"bird\"\ncount = " + std::to_string(count) +
           "\nspread_m = 5\nposition_ned_m = [100, " + std::to_string(east_m) + ", -150]\n";
  };
  const scene::Scene scene =
      scene::parse_scene("[background]\nvideo = \"none.mp4\"\n[lens]\nvertical_fov_deg = 60\n" +
                             flock(-20, 12) + flock(20, 7) + flock(0, 1),
                         "flocks.toml");
  const auto parties = parties_of(scene);
  ASSERT_EQ(parties.size(), 3u);
  EXPECT_EQ(parties[0].name, "bird-1 (12)");
  EXPECT_EQ(parties[1].name, "bird-2 (7)");
  EXPECT_EQ(parties[2].name, "bird-3");
  const setup::World world = setup::load_world(scene, {640, 480}, {});
  const setup::Moment moment = setup::moment_at(world, 0, 0, {});
  const auto rows = preview_rows(world, parties, {0}, [&](double) { return moment; });
  ASSERT_EQ(rows.size(), 3u);
  double nearest_m = HUGE_VAL;
  for (std::size_t i = 0; i < 12; ++i) {
    const Box& one = *moment.boxes[i].box;
    EXPECT_GE(one.x, rows[0].box_px->x);
    EXPECT_LE(one.bottom(), rows[0].box_px->bottom());
    nearest_m =
        std::min(nearest_m, (moment.states[i]->position_in_world - Vector3(0, 0, -150)).norm());
  }
  EXPECT_NEAR(rows[0].nearest.range_m, nearest_m, 1e-9);
  EXPECT_LT(rows[0].box_px->right(), rows[1].box_px->x);
  EXPECT_EQ(approach_lines(world, parties, {0, 1, 2}, 1).size(), 3u);
}

TEST(Preview, ThePictureShowsTheIntruderWhereTheRowsSay) {
  const test_support::TemporaryFolder folder;
  const fs::path video = folder / "flight.mp4";
  synthetic::FlightOptions flight;
  flight.frame_count = 130;
  flight.width = 320;
  flight.height = 240;
  demo::write_flight(synthetic::Flight(flight), video, {});
  const Preview made = preview_of(head_on(video), {});
  EXPECT_EQ(made.picture.width, 1960);
  ASSERT_EQ(made.rows.size(), 5u);

  // Once its motion is kept, each moment is shown as it is rendered.
  pipeline::Options options;
  options.cache = folder / "cache";
  EXPECT_FALSE(preview_of(head_on(video), options).has_motion);
  pipeline::measure_ahead(head_on(video), options);
  const Preview moved = preview_of(head_on(video), options);
  EXPECT_TRUE(moved.has_motion);
  scene::Scene scene = head_on(video);
  scene.render.quality = 1;
  const fs::path out = folder / "out";
  const annotation::Truth truth =
      annotation::read_truth(pipeline::render(scene, out, options).folder / "truth.jsonl");
  // It is in view until it is abeam, at 4 s.
  int in_view = 0;
  for (const PreviewRow& row : moved.rows) {
    if (!row.box_px) continue;
    ++in_view;
    const annotation::Frame& frame = truth.frames.at(static_cast<std::size_t>(30 * row.time_s));
    ASSERT_TRUE(frame.intruders[0].exact_box_px) << row.time_s;
    EXPECT_NEAR(row.box_px->x, frame.intruders[0].exact_box_px->x, 0.01) << row.time_s;
    EXPECT_NEAR(row.box_px->y, frame.intruders[0].exact_box_px->y, 0.01) << row.time_s;
  }
  EXPECT_GE(in_view, 3);
  options = {};

  scene::Scene seen = head_on(video);
  seen.intruders[0].encounter.reset();
  seen.intruders[0].seen = {{.time_s = 0, .pixel = {100, 100}, .range_m = 900},
                            {.time_s = 4, .pixel = {500, 100}, .range_m = 100}};
  std::vector<std::string> warnings;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  preview_of(seen, options);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0],
              testing::HasSubstr("c172/g-boix (light piston) cannot fly its path: at "));
  seen.intruders[0].seen[1].time_s = 4.4;  // the last frame is at 4.3 s
  try {
    preview_of(seen, options);
    ADD_FAILURE() << "expected an error";
  } catch (const Error& error) {
    EXPECT_THAT(
        error.what(),
        testing::HasSubstr("time_s is 4.400, where the clip has no frame: it ends at 4.300"));
  }
}

// Frames 0 to 5 within 0.17 s, 6 and 7 at 1.17 and 2.17 s, in containers that state 30 Hz: frames
// 30 and 60, which that rate has at 1 and 2 s, are none of the clip.
TEST(Preview, FramesOfAVariableRateHaveTheirNumbers) {
  const test_support::TemporaryFolder folder;
  test_support::write_flight(folder / "flight.mp4", 320, 240, 8);
  for (const std::string name : {"vfr.mkv", "vfr.mp4"})
    test_support::ffmpeg(folder.path(),
                         "-i flight.mp4 -vf \"setpts='if(lt(N,6),N/30,N-5+1/6)/TB'\" -fps_mode vfr "
                         "-c:v libx264 " +
                             name);
  for (int k = 0; k < 8; ++k)
    write_file(folder / ("mask" + std::to_string(k) + ".pgm"),
               "P5\n320 240\n255\n" + std::string(std::size_t{320} * 240, '\0'));
  for (const char* name : {"vfr.mkv", "vfr.mp4"}) {
    scene::Scene scene = head_on(folder / name);
    // One mask for each frame: that of a frame beyond them is an error.
    scene.occluders = {{50, folder / "mask%d.pgm", false, {}}};
    EXPECT_EQ(preview_of(scene, {}).rows.size(), 3u) << name;
  }
}

// Eight frames at 30 Hz with 3 s of sound, in a container that states the length of both alone.
TEST(Preview, AClipEndsWithItsLastFrame) {
  const test_support::TemporaryFolder folder;
  test_support::write_flight(folder / "flight.mp4", 320, 240, 8);
  test_support::ffmpeg(folder.path(),
                       "-i flight.mp4 -f lavfi -i sine=d=3 -c:v copy -c:a flac sound.mkv");
  scene::Scene scene = head_on(folder / "sound.mkv");
  EXPECT_EQ(preview_of(scene, {}).rows.size(), 1u);
  // More than are there, and fewer than the sound has.
  scene.background.frame_count = 30;
  std::vector<std::string> warnings;
  pipeline::Options options;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  preview_of(scene, options);
  EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr("has only 8 frames from there")));
}

}  // namespace
}  // namespace airtruth::preview
