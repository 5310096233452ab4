// SPDX-License-Identifier: Apache-2.0
#include "calibration/sensor/shutter.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

// Readouts of shaken pictures whose motion is a closed form.
namespace airtruth::sensor {
namespace {

constexpr int kWidth = 480;
constexpr int kHeight = 360;

// The place of the scene at a time in frames, and its change per frame.
Pixel place_at(double k) { return {20 * std::sin(0.42 * k), 15 * std::sin(0.65 * k + 1)}; }
Pixel speed_at(double k) {
  return {20 * 0.42 * std::cos(0.42 * k), 15 * 0.65 * std::cos(0.65 * k + 1)};
}

// The steps of pictures of which the column at x and the row at y are taken at the time
// (x - width / 2, y - height / 2) . delay after their middle, in frames.
Steps steps_of(const Pixel& delay) {
  Steps steps = {std::nullopt};
  const Pixel centre(kWidth / 2.0, kHeight / 2.0);
  for (int k = 1; k < 180; ++k) {
    const Eigen::Matrix2d bent =
        Eigen::Matrix2d::Identity() + (speed_at(k) - speed_at(k - 1)) * delay.transpose();
    Homography step = Homography::Identity();
    step.topLeftCorner<2, 2>() = bent;
    step.topRightCorner<2, 1>() = centre + place_at(k) - place_at(k - 1) - bent * centre;
    steps.emplace_back(step);
  }
  return steps;
}

TEST(Readout, AlongTheColumnsIsMeasuredWithItsDirection) {
  for (const double share : {-0.5, 0.0, 0.5}) {
    const auto found = readout_share({steps_of({0, share / kHeight})}, kWidth, kHeight);
    ASSERT_TRUE(found) << found.why();
    EXPECT_NEAR(found->value, share, 0.02);
  }
}

// A camera on its side: that a readout down the rows is none does not make it a global shutter.
TEST(Readout, AlongTheRowsIsNotTakenForNone) {
  const auto right = readout_share({steps_of({0.5 / kWidth, 0})}, kWidth, kHeight);
  EXPECT_THAT(right.why(), testing::HasSubstr("rows, to the right, in about 0.50 of a frame"));
  const auto left = readout_share({steps_of({-0.25 / kWidth, 0})}, kWidth, kHeight);
  EXPECT_THAT(left.why(), testing::HasSubstr("rows, to the left, in about 0.25 of a frame"));
}

}  // namespace
}  // namespace airtruth::sensor
