// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>

#include <airtruth/calibration.h>
#include <airtruth/motion.h>
#include <gtest/gtest.h>
#include <support/temporary_folder.h>

#include "camera/lens/calibration_file.h"
#include "camera/lens/lens.h"
#include "foundation/base/files.h"
#include "sequence/demo/demo.h"

namespace airtruth {
namespace {

// One clip for all tests.
class Clips : public testing::Test {
 protected:
  static constexpr int kFrames = 12;

  static void SetUpTestSuite() {
    folder_ = std::make_unique<test_support::TemporaryFolder>();
    synthetic::FlightOptions options;
    options.width = 160;
    options.height = 120;
    options.frame_count = kFrames;
    options.own_aircraft = false;
    demo::VirtualFlightOptions how;
    how.format = video::Format::kMkv;
    demo::write_flight(synthetic::Flight(options), video(), how);
    write_file(*folder_ / "lens.yml",
               lens::opencv_calibration(
                   lens::pinhole_from_vertical_fov(60, {options.width, options.height}), "a test"));
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static fs::path video() { return *folder_ / "flight.mkv"; }
  static MotionOptions uncached() {
    MotionOptions options;
    options.use_cache = false;
    return options;
  }

  inline static std::unique_ptr<test_support::TemporaryFolder> folder_;
};

TEST_F(Clips, MoveByHomographiesOrRotations) {
  const ClipMotion planar = measure_motion(video(), uncached());
  ASSERT_EQ(planar.frames.size(), std::size_t{kFrames});
  EXPECT_EQ(planar.width, 160);
  EXPECT_FALSE(planar.lens || planar.gyro);
  EXPECT_EQ(planar.frames[0].state, "reference");
  EXPECT_EQ(planar.frames[0].frame_from_reference,
            (std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  EXPECT_EQ(planar.frames[5].state, "measured");
  EXPECT_EQ(planar.frames[5].frame, 5);
  EXPECT_FALSE(planar.frames[5].cam_from_reference_cam);

  MotionOptions with_lens = uncached();
  with_lens.lens = *folder_ / "lens.yml";
  const ClipMotion turned = measure_motion(video(), with_lens);
  ASSERT_TRUE(turned.lens);
  EXPECT_EQ(turned.lens->height(), 120);
  const auto& q = turned.frames[5].cam_from_reference_cam;
  ASSERT_TRUE(q);
  EXPECT_NEAR(std::hypot(std::hypot((*q)[0], (*q)[1]), std::hypot((*q)[2], (*q)[3])), 1, 1e-12);
}

TEST_F(Clips, MoveAlikeWithTheCache) {
  MotionOptions options;
  options.cache = *folder_ / "cache";
  options.reference = "smoothed";
  const ClipMotion measured = measure_motion(video(), options);
  EXPECT_FALSE(fs::is_empty(options.cache / "motion"));
  const ClipMotion kept = measure_motion(video(), options);
  for (std::size_t k = 0; k < std::size_t{kFrames}; ++k) {
    EXPECT_EQ(measured.frames[k].frame_from_reference, kept.frames[k].frame_from_reference);
    EXPECT_EQ(measured.frames[k].rms_px, kept.frames[k].rms_px);
  }
}

TEST_F(Clips, RefuseWhatDoesNotFit) {
  MotionOptions options = uncached();
  options.model = "rotation";
  EXPECT_THROW(measure_motion(video(), options), Error);
  options.model = "sphere";
  EXPECT_THROW(measure_motion(video(), options), Error);
  options.model = "auto";
  EXPECT_THROW(measure_motion(*folder_ / "none.mkv", options), Error);
  std::stop_source source;
  source.request_stop();
  options.stop = source.get_token();
  EXPECT_THROW(measure_motion(video(), options), Interrupted);
}

TEST_F(Clips, AreCalibrated) {
  CalibrateOptions options;
  options.gamma = 2;
  const Calibration found = calibrate({video()}, options);
  EXPECT_EQ(found.frames, kFrames);
  EXPECT_EQ(found.quantities.size(), 15u);
  for (const CalibratedQuantity& quantity : found.quantities) {
    EXPECT_EQ(quantity.values.empty(), !quantity.missing.empty()) << quantity.name;
    if (quantity.name != "optics.point_spread_px") continue;
    ASSERT_EQ(quantity.values.size(), 1u);
    EXPECT_GT(quantity.values[0].sigma, 0);
    EXPECT_NE(found.toml.find("point_spread_px = "), std::string::npos);
  }
  EXPECT_EQ(calibrate({video(), video()}).clips, 2);
  EXPECT_FALSE(camera_profiles().empty());
  options.gamma = 1;
  EXPECT_THROW(calibrate({video()}, options), Error);
  EXPECT_THROW(calibrate({}), Error);
}

}  // namespace
}  // namespace airtruth
