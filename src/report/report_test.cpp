// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "image/colour.h"
#include "report/pictures.h"

namespace airtruth::report {
namespace {

image::Picture grey_picture(int width, int height, std::uint8_t level) {
  image::Rgb8 rgb = image::make_rgb8(width, height);
  std::fill_n(rgb.samples.get(),
              static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3,
              level);
  return image::picture_from_rgb8(rgb,
                                  {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
}

annotation::Frame frame_with_box(std::int64_t index, const PixelBox& box) {
  annotation::Frame frame;
  frame.frame = index;
  annotation::Intruder intruder;
  intruder.id = "b737";
  intruder.state = annotation::State::kVisible;
  intruder.range_m = 350;
  intruder.visible_box_px = box;
  frame.intruders.push_back(intruder);
  return frame;
}

TEST(Overlay, LeavesTheLabelledPixelsAndOutlinesThem) {
  const image::Picture picture = grey_picture(200, 150, 100);
  const image::Rgb8 result = overlay(picture, frame_with_box(0, {80, 60, 12, 8}));
  for (int y = 60; y < 68; ++y) {
    for (int x = 80; x < 92; ++x) EXPECT_EQ(result.at(x, y)[0], 100);
  }
  EXPECT_EQ(result.at(79, 64)[1], 255);  // the line just outside, green
  EXPECT_EQ(result.at(92, 64)[1], 255);
  EXPECT_EQ(result.at(85, 59)[1], 255);
  EXPECT_EQ(result.at(85, 68)[1], 255);
}

TEST(ContactSheet, KeepsAtMostTwelveTilesWhateverTheLength) {
  for (std::int64_t estimate : {0, 5, 40}) {
    ContactSheet sheet("name", estimate);
    for (std::int64_t i = 0; i < 40; ++i)
      sheet.add(grey_picture(64, 48, 90), frame_with_box(i, {10, 10, 4, 4}));
    const image::Rgb8 picture = sheet.sheet();
    EXPECT_EQ(picture.width, 10 + 3 * 650);
    EXPECT_LE(picture.height, 56 + 4 * 490) << estimate;
    EXPECT_GE(picture.height, 56 + 2 * 490) << estimate;
  }
  EXPECT_GT(ContactSheet("empty", 0).sheet().height, 0);
}

TEST(Closeup, EnlargesEachPixelToASquareOfItsOwnColour) {
  const image::Picture before = grey_picture(40, 30, 50);
  const image::Picture after = grey_picture(40, 30, 60);
  const image::Rgb8 result =
      closeup({&before, &after, nullptr}, frame_with_box(3, {30, 20, 2, 2}), {5, 5, 10, 8}, 8);
  EXPECT_EQ(result.width, 4 * 12 + 3 * 80);
  EXPECT_EQ(result.at(12 + 40, 34 + 30)[0], 50);
  EXPECT_EQ(result.at(12 + 80 + 12 + 40, 34 + 30)[0], 40);  // four times the difference of 10
  EXPECT_EQ(result.at(12 + 2 * (80 + 12) + 40, 34 + 30)[0], 60);
}

}  // namespace
}  // namespace airtruth::report
