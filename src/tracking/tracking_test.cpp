// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/seed.h"
#include "tracking/am3.h"
#include "tracking/pyramid.h"
#include "tracking/tracker.h"

namespace airtruth::tracking {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

// A soft sky with a dark patterned object at (x, y).
image::Picture scene(double x, double y, int width, int height, std::uint64_t noise) {
  image::Picture picture = image::make_picture(kWidth, kHeight, {});
  Random random(noise);
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      const double sky = 150 + 30 * std::sin(column / 23.0) * std::cos(row / 17.0) + row / 10.0;
      picture.planes[0].row(row)[column] = static_cast<std::uint8_t>(sky + random.uniform(-3, 3));
    }
  const int left = static_cast<int>(std::lround(x));
  const int top = static_cast<int>(std::lround(y));
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const bool dark = (i / 4 + j / 4) % 2 == 0 || j == height / 2;
      picture.planes[0].row(top + j)[left + i] = dark ? 50 : 90;
    }
  for (std::size_t p = 1; p < 3; ++p)
    for (int row = 0; row < picture.planes[p].height; ++row)
      std::fill_n(picture.planes[p].row(row), picture.planes[p].width, std::uint8_t{128});
  return picture;
}

Box where(int frame, int width, int height) {
  return {60 + 2.5 * frame, 80 + 12 * std::sin(frame / 4.0), double(width), double(height)};
}

// Mean distance of the centres over 60 frames.
double mean_error(const std::string& name, std::uint64_t seed, int width = 36, int height = 20) {
  const auto tracker = make_tracker(name, seed);
  Box box = where(0, width, height);
  image::Picture picture = scene(box.x, box.y, width, height, 1);
  tracker->load(picture);
  tracker->init({std::round(box.x), std::round(box.y), box.width, box.height});
  double sum = 0;
  for (int frame = 1; frame <= 60; ++frame) {
    box = where(frame, width, height);
    picture = scene(box.x, box.y, width, height, static_cast<std::uint64_t>(frame) + 1);
    tracker->load(picture);
    const Box found = tracker->update().box_px;
    sum += std::hypot(found.x + found.width / 2 - (std::round(box.x) + box.width / 2),
                      found.y + found.height / 2 - (std::round(box.y) + box.height / 2));
  }
  return sum / 60;
}

TEST(Am3, FollowsAnObjectThatMovesAndHoldsItsSize) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) EXPECT_LT(mean_error("am3", seed), 3) << seed;
}

TEST(Am3, ItsSpecialCasesFollowToo) {
  EXPECT_LT(mean_error("wmil", 1), 4);
  EXPECT_LT(mean_error("mil", 1), 4);
}

TEST(Am3, FollowsAnObjectOfAFewPixels) { EXPECT_LT(mean_error("am3", 1, 8, 4), 3); }

TEST(Am3, OneSeedIsOneResultAndAnotherIsAnother) {
  EXPECT_EQ(mean_error("am3", 7), mean_error("am3", 7));
  EXPECT_NE(mean_error("am3", 7), mean_error("am3", 8));
}

TEST(Am3, StaysWithinThePictureAtItsBorder) {
  const auto tracker = make_tracker("am3", 1);
  const image::Picture picture = scene(2, 3, 30, 18, 1);
  tracker->load(picture);
  tracker->init({-4, -3, 36, 24});
  for (int i = 0; i < 5; ++i) {
    const Answer answer = tracker->update();
    EXPECT_TRUE(std::isfinite(answer.box_px.x));
    EXPECT_FALSE(answer.lost);
  }
}

TEST(Trackers, OfOpenCvFollow) {
  for (const std::string& name : tracker_names()) {
    // MOSSE and MedianFlow are for smoother motion than this, TLD wanders: they must answer.
    const double error = mean_error(name, 1);
    EXPECT_TRUE(std::isfinite(error)) << name;
    if (name == "opencv-csrt" || name == "opencv-kcf") {
      EXPECT_LT(error, 10) << name;
    }
    if (name == "opencv-mil") {
      EXPECT_LT(error, 25) << name;
    }
  }
}

TEST(Trackers, RefuseABoxWithoutArea) {
  for (const std::string& name : tracker_names()) {
    const auto tracker = make_tracker(name, 1);
    const image::Picture picture = scene(60, 60, 30, 18, 1);
    tracker->load(picture);
    EXPECT_THROW(tracker->init({10, 10, 0, 5}), Error) << name;
    EXPECT_THROW(tracker->init({10, 10, NAN, 5}), Error) << name;
    EXPECT_THROW(tracker->init({1000, 10, 5, 5}), Error) << name;
  }
  EXPECT_THROW(make_tracker("am4", 1), Error);
}

TEST(Pyramid, SumsAreThoseOfThePixels) {
  const image::Picture picture = scene(60, 60, 30, 18, 5);
  const image::Plane& luma = picture.luma();
  const Pyramid pyramid(luma, {40, 48, 101, 77}, 3);
  for (int level = 0; level < 3; ++level) {
    const int scale = 1 << level;
    const int x = 3, y = 5, width = 9, height = 4;
    double sum = 0;
    for (int row = y * scale; row < (y + height) * scale; ++row)
      for (int column = x * scale; column < (x + width) * scale; ++column)
        sum += luma.row(48 + row)[40 + column];
    EXPECT_EQ(pyramid.sum(level, x, y, width, height), sum) << level;
    EXPECT_EQ(pyramid.width(level), 101 >> level);
  }
}

}  // namespace
}  // namespace airtruth::tracking
