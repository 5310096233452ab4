// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/patch.h"

#include <cmath>

#include <gtest/gtest.h>

namespace airtruth::motion {
namespace {

// Smooth waves in two directions, moved by (dx, dy), at another exposure.
cv::Mat waves(double dx, double dy, double brighter) {
  cv::Mat picture(64, 64, CV_8UC1);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const double u = x - dx, v = y - dy;
      const double luma =
          120 + brighter + 40 * std::sin(0.35 * u + 0.1 * v) + 30 * std::cos(0.3 * v - 0.07 * u);
      picture.at<unsigned char>(y, x) = static_cast<unsigned char>(std::lround(luma));
    }
  return picture;
}

TEST(Patch, AShiftIsFoundToATwentiethOfASampleAtAnyExposure) {
  const auto patch = Patch::at(waves(0, 0, 0), 22, 25);
  ASSERT_TRUE(patch);
  const auto found = patch->find(waves(1.37, -0.82, 25), 22, 25);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->x, 22 + 1.37, 0.05);
  EXPECT_NEAR(found->y, 25 - 0.82, 0.05);
  EXPECT_LT(found->unlikeness, 0.1);
}

TEST(Patch, WhatHasNoTextureOrLeavesThePictureIsNone) {
  EXPECT_FALSE(Patch::at(cv::Mat(64, 64, CV_8UC1, cv::Scalar(90)), 20, 20));
  EXPECT_FALSE(Patch::at(waves(0, 0, 0), 0, 20));
  EXPECT_FALSE(Patch::at(waves(0, 0, 0), 20, 48));
  EXPECT_FALSE(Patch::at(waves(0, 0, 0), 20, 20)->find(waves(0, 0, 0), -1, 20));
}

}  // namespace
}  // namespace airtruth::motion
