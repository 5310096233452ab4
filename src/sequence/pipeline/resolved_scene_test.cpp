// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/resolved_scene.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calibration/camera_file/cache.h"
#include "calibration/camera_file/profile.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "scene/scene/camera_keys.h"
#include "sequence/insertion/ambient.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/world.h"
#include "support/ffmpeg.h"
#include "support/flight_file.h"
#include "support/temporary_folder.h"

namespace airtruth::pipeline {
namespace {

// A calibration that is in the cache, so that no video is read: the file holds its checksum alone.
class Resolve : public testing::Test {
 protected:
  Resolve() {
    write_file(root_ / "clip.mkv", "no video");
    scene_.background.video = root_ / "clip.mkv";
    scene_.lens.vertical_fov_deg = 60;
    scene_.camera_model.automatic = {"sensor.codec_step"};
    info_.width = 640;
    info_.height = 480;
    options_.cache = root_;
  }

  void keep(const camera_file::Calibration& calibration) const {
    camera_file::CacheKey key;
    key.video_sha256 = sha256_of_file(scene_.background.video);
    key.lens = setup::words_of(setup::lens_of(scene_.lens, {info_.width, info_.height}));
    key.altitude_m = 150;
    key.tone = setup::tone_of(scene_.camera_model);
    camera_file::store(disk_cache::Cache(root_ / "calibration"), key, calibration);
  }

  scene::Scene resolve() const {
    setup::SharedInputs inputs;
    return with_measured_camera(
        stated(scene_, info_), {info_.width, info_.height}, nullptr, inputs, options_);
  }
  bool needs_calibration() const { return !stated(scene_, info_).to_measure.empty(); }

  test_support::TemporaryFolder temporary_;
  fs::path root_ = temporary_.path();
  scene::Scene scene_;
  video::StreamInfo info_;
  Options options_;
};

// The camera has turned by 30 degrees to the right when the scene begins, where it heads 10 degrees
// from north: the sun, 100 degrees to the right of the clip's first frame, stands at 80 degrees.
TEST_F(Resolve, TheSunIsTurnedToTheFrameWithWhichTheSceneBegins) {
  camera_file::Calibration found;
  found.quantities.at("sensor.codec_step").values = {{7, 1}};
  found.quantities.at("light.sun_azimuth_deg").values = {{100, 1}};
  found.quantities.at("light.sun_elevation_deg").values = {{40, 1}};
  found.yaw_from_first_deg = {0, 15, 30, 45};
  keep(found);
  scene_.camera.attitude_yaw_pitch_roll_deg = YawPitchRoll{10, 0, 0};
  scene_.background.first_frame = 2;
  const scene::Scene second = resolve();
  EXPECT_NEAR(second.light.sun_azimuth_deg, 80, 1e-9);
  EXPECT_DOUBLE_EQ(second.light.sun_elevation_deg, 40);
  EXPECT_EQ(second.camera_model.codec_step, 7);
  scene_.background.first_frame = 0;
  EXPECT_NEAR(resolve().light.sun_azimuth_deg, 110, 1e-9);
  // The clip is cut after four frames.
  scene_.background.first_frame = 4;
  EXPECT_EQ(resolve().light.sun_azimuth_deg, scene::Light().sun_azimuth_deg);
  EXPECT_EQ(resolve().light.sun_elevation_deg, scene::Light().sun_elevation_deg);
  scene_.background.first_frame = 0;
  // From 0 to 360.
  scene_.camera.attitude_yaw_pitch_roll_deg = YawPitchRoll{-150, 0, 0};
  EXPECT_NEAR(resolve().light.sun_azimuth_deg, 310, 1e-9);
}

// All scenes over a clip use the same calibration, whatever part of the clip they use.
TEST_F(Resolve, EveryPartOfAClipHasOneCamera) {
  camera_file::Calibration found;
  found.quantities.at("sensor.codec_step").values = {{1.0 / 3, 1}};
  keep(found);
  EXPECT_TRUE(needs_calibration());
  for (const std::int64_t first : {0, 5, 100})
    for (const std::int64_t count : {1, 90}) {
      scene_.background.first_frame = first;
      scene_.background.frame_count = count;
      EXPECT_EQ(resolve().camera_model.codec_step, 1.0 / 3);
    }
  scene_.camera_model.codec_step = 2;
  EXPECT_FALSE(needs_calibration());
}

std::string said_by(const std::function<void()>& what) {
  try {
    what();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// A clip without edges: an error where the scene allows no fallback, the median over cameras with
// fallback, the profile's value where one is named, and no value where none is requested.
TEST_F(Resolve, WhatTheClipCannotTellIsTheProfiles) {
  camera_file::Calibration found;
  found.width = info_.width, found.height = info_.height;
  found.quantities.at("optics.point_spread_px").missing = "no edges";
  keep(found);
  scene_.camera_model.automatic = {"optics.point_spread_px"};
  EXPECT_NE(said_by([&] { resolve(); }).find("cannot be measured: no edges; state it, name"),
            std::string::npos);
  std::vector<std::string> warnings;
  options_.warn = [&](const std::string& text) { warnings.push_back(text); };
  scene_.realism.fallback = true;
  EXPECT_EQ(resolve().camera_model.point_spread_px,
            camera_file::usual_camera().values.at("optics.point_spread_px").value);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("it is of the median over"), std::string::npos) << warnings[0];
  scene_.realism.profile = "none";
  EXPECT_FALSE(resolve().camera_model.point_spread_px);
  scene_.realism.fallback = false;
  scene_.realism.profile = "fixed-wing-nose";
  EXPECT_EQ(
      resolve().camera_model.point_spread_px,
      camera_file::camera_profile("fixed-wing-nose").values.at("optics.point_spread_px").value);
}

TEST_F(Resolve, AnExtinctionThatIsNotMeasuredIsSaid) {
  constexpr const char* kKey = "air.extinction_per_km";
  camera_file::Calibration found;
  found.width = info_.width, found.height = info_.height;
  found.quantities.at(kKey).values.assign(3, {0, 0.1});
  found.quantities.at(kKey).note = "not measured, and drawn as clear air: no ground";
  keep(found);
  scene_.camera_model.automatic = {kKey};
  std::vector<std::string> warnings;
  options_.warn = [&](const std::string& text) { warnings.push_back(text); };
  EXPECT_EQ(resolve().camera_model.extinction_per_km, (std::array<double, 3>{}));
  EXPECT_EQ(warnings,
            (std::vector<std::string>{
                "air.extinction_per_km is not measured, and drawn as clear air: no ground"}));
}

TEST_F(Resolve, AClipWithoutEdgesOfColourIsNoReasonToStop) {
  constexpr const char* kKey = "sensor.chroma_spread_px";
  camera_file::Calibration found;
  found.width = info_.width, found.height = info_.height;
  found.quantities.at(kKey).missing = "no colour";
  keep(found);
  scene_.camera_model.automatic = {kKey};
  std::vector<std::string> warnings;
  options_.warn = [&](const std::string& text) { warnings.push_back(text); };
  EXPECT_EQ(resolve().camera_model.chroma_spread_px,
            camera_file::usual_camera().values.at(kKey).value);
  scene_.realism.profile = "none";
  EXPECT_FALSE(resolve().camera_model.chroma_spread_px);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("no colour; it is of the median over"), std::string::npos);
  EXPECT_NE(warnings[1].find("no colour; it is left out"), std::string::npos) << warnings[1];
}

// The values of a clip that is not H.264. `auto` requests every value that can be measured, and
// uses the codec step where there is one.
TEST_F(Resolve, AutoTakesTheCodecsStepWhereTheDecoderTellsIt) {
  constexpr const char* kKey = "sensor.codec_step";
  camera_file::Calibration found;
  found.width = info_.width, found.height = info_.height;
  scene::for_each_camera_key(
      [&](const std::string& key, const auto&) {
        found.quantities.at(key).values.assign(key.starts_with("air.") ? 3 : 1, {0.1, 0.01});
      },
      scene_.camera_model);
  found.readout_direction = "down";
  found.quantities.at(kKey).values = {{7, 1}};
  keep(found);
  scene_.camera_model.automatic.clear();
  scene_.realism.automatic = true;
  scene_.realism.profile = "none";
  std::vector<std::string> warnings;
  options_.warn = [&](const std::string& text) { warnings.push_back(text); };
  EXPECT_EQ(resolve().camera_model.codec_step, 7);
  EXPECT_TRUE(warnings.empty());
  found.quantities.at(kKey).values.clear();
  found.quantities.at(kKey).missing = "no quantiser";
  keep(found);
  EXPECT_FALSE(resolve().camera_model.codec_step);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("no quantiser; it is left out"), std::string::npos) << warnings[0];
}

TEST_F(Resolve, AFileThatIsNotThereIsAnErrorAtTheTableThatNamesIt) {
  const std::string none = (root_ / "none.png").string();
  scene_.background.where = {"s.toml", 3, 1};
  scene_.background.mask = none;
  EXPECT_EQ(said_by([&] { stated(scene_, info_); }),
            "s.toml:3:1: " + none + " does not exist; expected a file");
  scene_.background.mask.reset();
  scene_.occluders = {{800, root_ / "hill/%05d.png", false, {"s.toml", 9, 1}}};
  EXPECT_EQ(said_by([&] { stated(scene_, info_); }), "");
  scene_.background.video = none;
  EXPECT_EQ(said_by([&] { open_background(scene_, options_); }),
            "s.toml:3:1: " + none + " does not exist; expected a file");
}

// Of 240 x 240 pixels that are 4/3 as wide as high, under 60 degrees of view: focal lengths of
// 120 / tan(30 deg) = 207.8 px in heights and of 155.9 px in widths, 181.9 px in the mean.
TEST_F(Resolve, PixelsThatAreNotSquareHaveOneLens) {
  test_support::write_flight(root_ / "flight.mp4", 320, 240, 3);
  test_support::ffmpeg(root_, "-i flight.mp4 -vf scale=240:240,setsar=4/3 clip.mkv");
  info_.width = info_.height = 240;
  info_.sample_aspect = {4, 3};
  const scene::Lens stated_lens = scene_.lens;
  setup::take_pixel_shape(scene_.lens, {240, 240}, 4 / 3.0);
  camera_file::Calibration found;
  found.quantities.at("sensor.codec_step").values = {{7, 1}};
  keep(found);
  scene_.lens = stated_lens;
  write_file(root_ / "camera.toml",
             "[clip]\nwidth = 240\nheight = 240\nlens = \"pinhole 181.9 px\"\n");
  scene_.realism.file = root_ / "camera.toml";
  EXPECT_EQ(resolve().camera_model.codec_step, 7);
  EXPECT_EQ(calibration_of(scene_, options_).quantities.at("sensor.codec_step").value().value, 7);
}

TEST_F(Resolve, AProfileThatCannotServeIsRefusedBeforeAnythingIsMeasured) {
  scene_.realism.where = {"s.toml", 7, 1};
  scene_.realism.profile = "fixed-wing-nos";
  EXPECT_NE(said_by([&] { needs_calibration(); })
                .find("s.toml:7:1: there is no camera profile 'fixed-wing-nos'; did you mean "
                      "'fixed-wing-nose'?"),
            std::string::npos);
  scene_.realism.profile = "gopro-karma";
  EXPECT_NE(said_by([&] { needs_calibration(); }).find("the clip is 640 x 480"), std::string::npos);
  scene_.realism.profile = "fixed-wing-nose";
  scene_.camera_model.automatic.clear();
  EXPECT_NE(said_by([&] { needs_calibration(); }).find("expected auto = true"), std::string::npos);
}

}  // namespace
}  // namespace airtruth::pipeline
