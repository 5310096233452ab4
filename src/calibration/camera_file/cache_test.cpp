// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/cache.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "camera/lens/lens.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/writer.h"
#include "scene/synthetic/flight.h"
#include "support/temporary_folder.h"

namespace airtruth::camera_file {
namespace {

class CalibrationCache : public testing::Test {
 protected:
  // 12 frames of 96 x 72 pixels.
  fs::path clip() const {
    synthetic::FlightOptions how;
    how.width = 96;
    how.height = 72;
    how.frame_count = 12;
    const synthetic::Flight flight(how);
    video::StreamInfo info;
    info.width = how.width;
    info.height = how.height;
    info.frame_count_estimate = how.frame_count;
    const fs::path file = root_ / "clip.mkv";
    video::WriterOptions options;
    options.format = video::Format::kMkv;
    video::Writer writer(file, info, options);
    for (int k = 0; k < how.frame_count; ++k) {
      video::Frame frame;
      frame.index = k;
      frame.pts = k;
      frame.time_s = k / 30.0;
      frame.picture = flight.frame(k);
      writer.write(frame);
    }
    writer.finish();
    return file;
  }

  const test_support::TemporaryFolder root_;
  const disk_cache::Cache cache_{root_.path()};
};

// For numbers without a finite decimal fraction the cached value equals the measured one to the
// last bit.
void expect_same(const Quantity& found, const Quantity& expected, const char* name) {
  EXPECT_EQ(found.missing, expected.missing) << name;
  EXPECT_EQ(found.note, expected.note) << name;
  ASSERT_EQ(found.values.size(), expected.values.size()) << name;
  for (std::size_t i = 0; i < expected.values.size(); ++i) {
    EXPECT_EQ(found.values[i].value, expected.values[i].value) << name;
    EXPECT_EQ(found.values[i].sigma, expected.values[i].sigma) << name;
  }
}

TEST_F(CalibrationCache, WhatIsKeptComesBackToTheLastBit) {
  Calibration c;
  c.width = 640;
  c.height = 480;
  c.frames = 300;
  c.frame_rate_hz = 30000.0 / 1001;
  c.lens = "fisheye 562.7 px";
  c.quantities.at("sensor.noise_gain").values = {{1.0 / 3, 1e-17}};
  c.quantities.at("air.airlight").values = {{0.1, 0.2}, {0.3, 2.0 / 7}, {1.0 / 9, 5e-324}};
  c.quantities.at("shutter.exposure_s").missing = "the clip is too still";
  c.quantities.readout.note = "by 2 of 3 clips";
  c.no_horizon = "none is straight";
  c.horizon_note = "by 2 frames";
  c.readout_direction = "up";
  c.downwards_s = {-1.0 / 7, 1.0 / 9};
  c.yaw_from_first_deg = {0, 1.0 / 7, -179.9};
  const CacheKey key{"v", "m", "lens", 150, {}};
  EXPECT_FALSE(cached(cache_, key));
  store(cache_, key, c);
  const auto found = cached(cache_, key);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->width, c.width);
  EXPECT_EQ(found->height, c.height);
  EXPECT_EQ(found->no_horizon, c.no_horizon);
  EXPECT_EQ(found->horizon_note, c.horizon_note);
  EXPECT_EQ(found->frames, 300);
  EXPECT_EQ(found->frame_rate_hz, c.frame_rate_hz);
  EXPECT_EQ(found->lens, c.lens);
  EXPECT_EQ(found->readout_direction, c.readout_direction);
  ASSERT_TRUE(found->downwards_s);
  EXPECT_EQ(found->downwards_s->value, c.downwards_s->value);
  EXPECT_EQ(found->downwards_s->sigma, c.downwards_s->sigma);
  EXPECT_EQ(found->yaw_from_first_deg, c.yaw_from_first_deg);
  for (const QuantityKey& one_of : kQuantityKeys)
    expect_same(found->quantities.*one_of.member, c.quantities.*one_of.member, one_of.name);
}

TEST_F(CalibrationCache, EverythingThatTheNumbersDependOnIsInTheKey) {
  const CacheKey key{"v", "m", "lens", 150, {}};
  std::vector<CacheKey> others(7, key);
  others[0].video_sha256 = "w";
  others[1].mask_sha256 = "";
  others[2].lens = "other";
  others[3].altitude_m = 151;
  others[4].altitude_m.reset();
  others[5].tone.gamma = 2.2;
  others[6].picture_rate_hz = 30;
  for (const CacheKey& other : others) EXPECT_NE(other.entry().name(), key.entry().name());
}

TEST_F(CalibrationCache, ADamagedFileIsNotTrusted) {
  const CacheKey key{"v", "", "lens", std::nullopt, {}};
  store(cache_, key, {});
  const fs::path file = root_ / key.entry().name();
  const std::string text = read_file(file);
  for (const std::string& bad : {text.substr(0, text.size() / 2), std::string(), text + " "}) {
    write_file(file, bad);
    EXPECT_FALSE(cached(cache_, key));
  }
  cache_.keep(key.entry(), "[1]\n");  // whole, and not ours
  EXPECT_FALSE(cached(cache_, key));
}

TEST_F(CalibrationCache, OfManyThatAskAtOnceOneMeasures) {
  const fs::path video = clip();
  std::atomic<int> passes = 0;
  std::vector<Calibration> found(4);
  {
    std::vector<std::jthread> threads;
    for (Calibration& mine : found)
      threads.emplace_back([&] {
        Options options;
        options.lens = lens::pinhole_from_vertical_fov(75, {96, 72});
        options.progress = [&](std::int64_t done, std::int64_t) { passes += done == 1 ? 1 : 0; };
        mine = calibrate_once(video, options, cache_, {"v", "", "lens", {}, {}});
      });
  }
  EXPECT_EQ(passes, 1);
  for (const Calibration& one : found) {
    EXPECT_EQ(one.frames, 12);
    for (const QuantityKey& one_of : kQuantityKeys)
      expect_same(one.quantities.*one_of.member, found[0].quantities.*one_of.member, one_of.name);
  }
}

TEST_F(CalibrationCache, AFolderThatTakesNoFileCostsTheMeasurementAlone) {
  const fs::path video = clip();
  write_file(root_ / "file", "no folder");
  const Calibration found = calibrate_once(
      video, {}, disk_cache::Cache(root_ / "file" / "cache"), {"v", "", "lens", {}, {}});
  EXPECT_EQ(found.frames, 12);
}

}  // namespace
}  // namespace airtruth::camera_file
