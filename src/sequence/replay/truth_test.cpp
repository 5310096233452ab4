// SPDX-License-Identifier: Apache-2.0
// Compares the truth.jsonl of a rendered sequence with independent computations.
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "labels/annotation/evision.h"
#include "labels/projection/exact_box.h"
#include "picture/composite/cover.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "sequence/demo/demo.h"
#include "sequence/insertion/masks.h"
#include "sequence/pipeline/render.h"
#include "sequence/replay/finished.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/world.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

namespace airtruth::replay {
namespace {

constexpr int kReplayWidth = 160;
constexpr int kReplayHeight = 120;
constexpr int kReplayFrames = 8;

// A camera that turns about a point, 2 degrees rms in pitch and yaw.
synthetic::FlightOptions turning_flight() {
  synthetic::FlightOptions options;
  options.width = kReplayWidth;
  options.height = kReplayHeight;
  options.frame_count = kReplayFrames;
  options.own_aircraft = false;
  options.shake_deg = 2;
  options.translate = false;
  return options;
}

class TruthOf : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = temporary_.emplace().path();
    demo::VirtualFlightOptions how;
    how.format = video::Format::kMkv;
    demo::write_flight(synthetic::Flight(turning_flight()), root_ / "flight.mkv", how);
  }
  static void TearDownTestSuite() { temporary_.reset(); }

  // The camera stands level at (0, 0, -150) and looks north.
  static Finished rendered(const std::string& intruders,
                           const std::string& tables,
                           const std::string& background = "",
                           const std::string& output = "",
                           int threads = 0) {
    static int number = 0;
    const std::string name = "s" + std::to_string(number++);
    const std::string text = "name = \"" + name + "\"\n[background]\nvideo = \"flight.mkv\"\n" +
                             background +
                             "[lens]\nmodel = \"pinhole\"\nvertical_fov_deg = 75\n"
                             "[camera]\nposition_ned_m = [0, 0, -150]\n"
                             "attitude_yaw_pitch_roll_deg = [0, 0, 0]\n" +
                             tables + intruders + "[output]\nvideo = \"mkv\"\n" + output;
    pipeline::Options options;
    options.use_cache = false;
    options.threads = threads;
    return open_finished(
        pipeline::render(scene::parse_scene(text, root_ / "scene.toml"), root_ / "out", options)
            .folder);
  }

  static inline std::optional<test_support::TemporaryFolder> temporary_;
  static inline fs::path root_;
};

const std::string kStill = "[motion]\nmodel = \"none\"\n";
const std::string kSpread = "[optics]\npoint_spread_px = 0.7\n";

std::string replayed_intruder(const std::string& id,
                              const std::string& aircraft,
                              const std::string& way) {
  return "[[intruder]]\nid = \"" + id + "\"\naircraft = \"" + aircraft +
         "\"\nwaypoints_ned_m = " + way + "\nspeed_mps = 60\n";
}

TEST_F(TruthOf, OneIntruderThroughAPointSpreadIsHiddenByNothing) {
  // From within the view out over its right edge.
  const Finished finished =
      rendered(replayed_intruder("one", "738/738-Ryanair", "[[80, 60, -150], [80, 160, -150]]"),
               kStill + kSpread);
  int cut = 0;
  for (const annotation::Frame& frame : finished.truth.frames) {
    EXPECT_EQ(frame.intruders[0].hidden_by_intruder, 0) << frame.frame;
    EXPECT_EQ(frame.intruders[0].hidden_by_own_aircraft, 0) << frame.frame;
    cut += frame.intruders[0].cut_by_frame > 0 ? 1 : 0;
  }
  EXPECT_GT(cut, 0);
}

// A mask beside an intruder takes some of its spread light and hides none of it.
TEST_F(TruthOf, WhatHidesAnIntruderDoesNotDependOnThePointSpread) {
  image::Rgb8 mask = image::make_rgb8(kReplayWidth, kReplayHeight);
  for (int y = 0; y < kReplayHeight; ++y)
    for (int x = 60; x < kReplayWidth; ++x) std::fill_n(mask.at(x, y), 3, std::uint8_t{255});
  video::write_still(root_ / "left.png", mask);
  const std::string two =
      replayed_intruder("far", "738/738-Ryanair", "[[160, -25, -150], [160, 60, -150]]") +
      replayed_intruder("near", "c172/news", "[[60, -2, -150], [60, 60, -150]]");
  const std::string mask_key = "mask = \"left.png\"\n";
  const Finished sharp = rendered(two, kStill, mask_key);
  const Finished soft = rendered(two, kStill + kSpread, mask_key);
  int by_intruder = 0, by_mask = 0, by_nothing = 0;
  for (std::size_t k = 0; k < sharp.truth.frames.size(); ++k)
    for (std::size_t i = 0; i < 2; ++i) {
      const annotation::Intruder& a = sharp.truth.frames[k].intruders[i];
      const annotation::Intruder& b = soft.truth.frames[k].intruders[i];
      EXPECT_EQ(a.hidden_by_intruder, b.hidden_by_intruder) << k << ' ' << i;
      EXPECT_EQ(a.hidden_by_own_aircraft, b.hidden_by_own_aircraft) << k << ' ' << i;
      EXPECT_EQ(a.cut_by_frame, b.cut_by_frame) << k << ' ' << i;
      by_intruder += b.hidden_by_intruder > 0.01 ? 1 : 0;
      by_mask += b.hidden_by_own_aircraft > 0.01 ? 1 : 0;
      by_nothing += b.hidden_by_intruder + b.hidden_by_own_aircraft == 0 ? 1 : 0;
    }
  EXPECT_GT(by_intruder, 0);
  EXPECT_GT(by_mask, 0);
  EXPECT_GT(by_nothing, 0);
}

// An insect alone, 40 px farther to the right in each frame.
TEST_F(TruthOf, WhatIsOnTheLensAndWhollyBeyondTheFrameIsCut) {
  const Finished finished = rendered(
      "[[distractor]]\nkind = \"insect\"\npixel = [80, 60]\nvelocity_px_s = [1200, 0]\n", kStill);
  int beyond = 0;
  for (const annotation::Frame& frame : finished.truth.frames) {
    const annotation::Intruder& insect = frame.intruders[0];
    const bool is_beyond = insect.exact_box_px->x >= kReplayWidth;
    EXPECT_EQ(insect.cut_by_frame == 1, is_beyond) << frame.frame;
    beyond += is_beyond ? 1 : 0;
  }
  EXPECT_GT(beyond, 0);
  EXPECT_LT(beyond, kReplayFrames);
}

// The flight's own pose gives the expected value: a direction of the first frame's camera, rotated
// as the camera truly rotated until frame k. The scene's camera stands still, so nominal bearings
// stay.
TEST_F(TruthOf, TheBearingIsInTheCameraAsItReallyLooked) {
  const synthetic::Flight flight(turning_flight());
  const auto cam_from_world = [&](int k) {
    return cam_from_body() * flight.camera(k).world_from_body.conjugate();
  };
  for (const char* model : {"homography", "rotation"}) {
    const Finished finished =
        rendered(replayed_intruder("one", "738/738-Ryanair", "[[300, 20, -170], [300, 80, -175]]"),
                 std::string("[motion]\nmodel = \"") + model + "\"\n");
    const lens::Lens lens = setup::lens_of(finished.scene->lens, {kReplayWidth, kReplayHeight});
    double moved_deg = 0;
    for (const annotation::Frame& frame : finished.truth.frames) {
      SCOPED_TRACE(testing::Message() << model << ' ' << frame.frame);
      const annotation::Intruder& one = frame.intruders[0];
      ASSERT_TRUE(one.azimuth_deg && one.nominal_azimuth_deg && one.centroid_px);
      // Straight lines: north, east and down of the intruder from the camera are x forward, y
      // right.
      const Vector3 offset =
          vector_of(*one.position_ned_m) - vector_of(frame.camera_position_ned_m);
      EXPECT_NEAR(*one.nominal_azimuth_deg, degrees(std::atan2(offset.y(), offset.x())), 1e-9);
      EXPECT_NEAR(*one.nominal_elevation_deg,
                  degrees(std::atan2(-offset.z(), std::hypot(offset.x(), offset.y()))),
                  1e-9);
      const int k = static_cast<int>(frame.frame);
      const Vector3 nominal = cam_from_body() * offset.normalized();
      const projection::Bearing truth =
          projection::bearing_of(cam_from_world(k) * (cam_from_world(0).conjugate() * nominal));
      constexpr double kMeasuredDeg = 0.35;  // half a pixel of this small picture
      EXPECT_NEAR(*one.azimuth_deg, truth.azimuth_deg, kMeasuredDeg);
      EXPECT_NEAR(*one.elevation_deg, truth.elevation_deg, kMeasuredDeg);
      moved_deg = std::max(moved_deg, std::abs(*one.azimuth_deg - *one.nominal_azimuth_deg));
      // Through the lens alone the bearing is the pixel where the intruder is.
      const auto pixel =
          lens.pixel_from_cam(cam_from_body() * unit_vector(*one.azimuth_deg, *one.elevation_deg));
      ASSERT_TRUE(pixel);
      const Box& exact = *one.exact_box_px;
      EXPECT_LT(std::abs(pixel->x() - (exact.x + exact.width / 2)), 0.5 * exact.width);
      EXPECT_LT(std::abs(pixel->y() - (exact.y + exact.height / 2)), 0.5 * exact.height + 0.5);
      const Pixel centroid = pixel_of(*one.centroid_px);
      EXPECT_LT((*pixel - centroid).norm(), 0.5 * exact.width);
    }
    EXPECT_GT(moved_deg, 1) << model;
  }
}

const std::string kReplayedScene =
    kStill +
    "[shutter]\nexposure_s = 0.01\n[air]\nextinction_per_km = [0.2, 0.25, 0.3]\n"
    "[optics]\npoint_spread_px = 0.8\nsharpening = 0.5\n"
    "[sensor]\nnoise_gain = 4e-4\nnoise_floor = 2e-5\nnoise_correlation_px = 0.5\n"
    "chroma_spread_px = 1.5\n";

// Sharpening, noise and the codec's quantiser move samples far around; the covered box stays.
TEST_F(TruthOf, TheCoveredBoxDoesNotFollowWhatTheCameraDoesToTheSamples) {
  const std::string one =
      replayed_intruder("one", "738/738-Ryanair", "[[300, -20, -170], [300, 80, -170]]");
  const Finished coded = rendered(one, kReplayedScene + "codec_step = 16\n");
  const Finished plain =
      rendered(one, kStill + "[shutter]\nexposure_s = 0.01\n[optics]\npoint_spread_px = 0.8\n");
  int wider = 0;
  for (std::size_t k = 0; k < coded.truth.frames.size(); ++k) {
    const annotation::Intruder& a = coded.truth.frames[k].intruders[0];
    const annotation::Intruder& b = plain.truth.frames[k].intruders[0];
    ASSERT_TRUE(a.covered_box_px && b.covered_box_px && a.visible_box_px);
    EXPECT_EQ(a.covered_box_px, b.covered_box_px) << k;
    wider += a.visible_box_px->width > a.covered_box_px->width + 2 ? 1 : 0;
    // An independent computation: the projected shape, swept by the shutter. The point spread adds
    // 1.3 px to a side that is opaque up to its edge, and removes thin parts.
    const Box& exact = *a.exact_box_px;
    EXPECT_NEAR(a.covered_box_px->x, exact.x, 2) << k;
    EXPECT_NEAR(a.covered_box_px->right(), exact.right(), 2) << k;
    EXPECT_NEAR(a.covered_box_px->y, exact.y, 2) << k;
    EXPECT_NEAR(a.covered_box_px->bottom(), exact.bottom(), 2) << k;
  }
  EXPECT_GT(wider, 0);
}

TEST_F(TruthOf, ATruthOfAnotherLengthThanItsVideoIsRefused) {
  Finished finished = rendered(
      replayed_intruder("one", "c172/news", "[[100, -20, -150], [100, 20, -150]]"), kStill);
  const fs::path file = finished.folder / "truth.jsonl";
  const std::string text = read_file(file);
  write_file(file, text.substr(0, text.rfind('\n', text.size() - 2) + 1));
  EXPECT_EQ(test_support::error_of([&] { open_finished(finished.folder); }),
            file.string() + ": has 7 lines; expected 8, one for each frame of the video");
  finished.truth.frames.push_back(finished.truth.frames.back());
  EXPECT_THAT(test_support::error_of([&] { write_overlay(finished, root_ / "look.mkv", {}); }),
              testing::HasSubstr("holds 8 frames; expected 9, one for each line of truth.jsonl"));
}

// Three panels, each of the frame and a margin of at most a quarter of it on both sides.
TEST_F(TruthOf, WhatPassesNearByIsShownInTheFrame) {
  Finished finished = rendered(
      replayed_intruder("one", "c172/news", "[[100, -20, -150], [100, 20, -150]]"), kStill);
  finished.truth.frames[3].intruders[0].exact_box_px = Box{-2000, -2000, 4000, 4000};
  const image::Rgb8 shown = inspect(finished, 3, "", 1);
  EXPECT_GT(shown.width, 3 * kReplayWidth);
  EXPECT_LT(shown.width, 6 * kReplayWidth);
}

// The same frames in another file.
TEST_F(TruthOf, ABackgroundThatIsAnotherFileIsNotShown) {
  const Finished finished = rendered(
      replayed_intruder("one", "c172/news", "[[100, -20, -150], [100, 20, -150]]"), kStill);
  const auto shown = [&] { return test_support::error_of([&] { inspect(finished, 3, "", 2); }); };
  EXPECT_EQ(shown(), "no error");
  const fs::path video = root_ / "flight.mkv";
  const std::string bytes = read_file(video);
  write_file(video, bytes + "more");
  EXPECT_THAT(shown(), testing::StartsWith(video.string() + ": is another file than the one that"));
  write_file(video, bytes);
}

TEST_F(TruthOf, AnOverlayOfPicturesHasTheRateOfTheTruth) {
  Finished finished = rendered(
      replayed_intruder("one", "738/738-Ryanair", "[[80, 0, -150], [80, 60, -150]]"), kStill);
  fs::create_directories(root_ / "pictures");
  video::Reader frames(finished.video);
  while (const auto frame = frames.next())
    video::write_still(root_ / "pictures" / fmt::format("{:04}.png", frame->index), frame->picture);
  finished.video = root_ / "pictures" / "%04d.png";
  write_overlay(finished, root_ / "pictures.mkv", {});
  EXPECT_NEAR(video::Reader(root_ / "pictures.mkv").info().frame_rate.value(),
              turning_flight().frame_rate_hz,
              0.1);
}

TEST_F(TruthOf, AnAircraftThatCoversNoPixelFarEnoughHasNoCoveredBox) {
  // 0.5 px of light aircraft, seen from behind through a wide point spread.
  const Finished finished =
      rendered(replayed_intruder("far", "c172/news", "[[1500, 0, -250], [1600, 0, -250]]"),
               kStill + "[optics]\npoint_spread_px = 2\n");
  const std::string text = read_file(finished.folder / "truth.jsonl");
  EXPECT_NE(text.find("\"covered_box_px\":null,\"covered_area_px\":null"), std::string::npos);
  for (const annotation::Frame& frame : finished.truth.frames) {
    EXPECT_TRUE(frame.intruders[0].exact_box_px);
    EXPECT_FALSE(frame.intruders[0].covered_box_px);
  }
}

TEST_F(TruthOf, TheEvisionRectangleIsTheCoveredBox) {
  const Finished finished =
      rendered(replayed_intruder("one", "738/738-Ryanair", "[[200, -20, -170], [200, 80, -170]]"),
               kReplayedScene);
  const auto evision = annotation::read_evision(finished.folder / (finished.name + ".xml"));
  ASSERT_EQ(evision.frames.size(), finished.truth.frames.size());
  for (std::size_t k = 0; k < evision.frames.size(); ++k)
    EXPECT_EQ(evision.frames[k]->rect_px, *finished.truth.frames[k].intruders[0].covered_box_px);
}

// The masks are grey pictures of the frame's size: their sum is alpha_sum_px, their bounds are
// covered_box_px, and no pixel of two intruders or of the own aircraft counts twice.
TEST_F(TruthOf, MasksHoldThePixelsOfEachIntruder) {
  image::Rgb8 mask = image::make_rgb8(kReplayWidth, kReplayHeight);
  for (int y = 0; y < kReplayHeight; ++y)
    for (int x = 70; x < kReplayWidth; ++x) std::fill_n(mask.at(x, y), 3, std::uint8_t{255});
  video::write_still(root_ / "own.png", mask);
  const std::string two =
      replayed_intruder("far", "738/738-Ryanair", "[[160, -25, -150], [160, 60, -150]]") +
      replayed_intruder("near", "c172/news", "[[60, -2, -150], [60, 60, -150]]");
  const Finished finished =
      rendered(two, kReplayedScene, "mask = \"own.png\"\n", "masks = true\n", 1);
  const auto record =
      nlohmann::json::parse(read_file(finished.folder / "sequence.json")).at("outputs");
  int hidden_in_part = 0;
  for (const annotation::Frame& frame : finished.truth.frames) {
    std::vector<int> both(kReplayWidth * kReplayHeight, 0);
    for (const annotation::Intruder& one : frame.intruders) {
      SCOPED_TRACE(one.id + " " + std::to_string(frame.frame));
      const std::string name = insertion::mask_name(one.id, frame.frame);
      EXPECT_EQ(name.substr(0, 6), "masks/");
      const fs::path file = finished.folder / name;
      ASSERT_EQ(fs::exists(file), one.state == annotation::State::kVisible);
      if (!fs::exists(file)) continue;
      const auto listed = std::find_if(
          record.begin(), record.end(), [&](const auto& f) { return f.at("name") == name; });
      ASSERT_NE(listed, record.end());
      EXPECT_EQ(listed->at("sha256"), sha256_of_file(file));
      const video::Grey grey = video::read_grey(file);
      ASSERT_EQ(grey.width, kReplayWidth);
      ASSERT_EQ(grey.height, kReplayHeight);
      double sum = 0;
      std::optional<PixelBox> covered;
      std::int64_t covered_area_px = 0;
      for (int y = 0; y < kReplayHeight; ++y)
        for (int x = 0; x < kReplayWidth; ++x) {
          const int a = grey.samples[static_cast<std::size_t>(y * kReplayWidth + x)];
          sum += a / 255.0;
          both[static_cast<std::size_t>(y * kReplayWidth + x)] += a;
          EXPECT_TRUE(a == 0 || x >= 70);
          const PixelBox pixel{x, y, 1, 1};
          if (a >= 20) covered = covered ? bounds(*covered, pixel) : pixel;
          covered_area_px += a >= 20 ? 1 : 0;
        }
      EXPECT_EQ(covered, one.covered_box_px);
      EXPECT_EQ(covered_area_px, one.covered_area_px.value_or(0));
      // Half a step of 8 bits for each pixel that the spread can reach.
      const Box& e = *one.exact_box_px;
      EXPECT_NEAR(sum, one.alpha_sum_px, 0.5 / 255 * (e.width + 8) * (e.height + 8));
      hidden_in_part += one.hidden_by_intruder > 0 && one.hidden_by_intruder < 1 ? 1 : 0;
    }
    for (const int a : both) EXPECT_LE(a, 256);  // two roundings
  }
  EXPECT_GT(hidden_in_part, 0);
  const Recomposition again = recompose(finished, 2, {});
  EXPECT_THAT(again.faults, testing::ElementsAre());
  const Finished with_two =
      rendered(two, kReplayedScene, "mask = \"own.png\"\n", "masks = true\n", 2);
  for (const auto& entry : fs::recursive_directory_iterator(finished.folder / "masks")) {
    if (!entry.is_regular_file()) continue;
    const fs::path name = fs::relative(entry.path(), finished.folder);
    EXPECT_EQ(sha256_of_file(entry.path()), sha256_of_file(with_two.folder / name));
  }
}

TEST_F(TruthOf, WithoutMasksThereIsNoSuchFolder) {
  const Finished finished =
      rendered(replayed_intruder("one", "c172/news", "[[60, -2, -150], [60, 60, -150]]"), kStill);
  EXPECT_FALSE(fs::exists(finished.folder / "masks"));
}

}  // namespace
}  // namespace airtruth::replay
