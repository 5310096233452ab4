// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "show/drawing/pictures.h"
#include "show/drawing/thumbnails.h"

namespace airtruth::drawing {
namespace {

image::Picture grey_picture(int width, int height, std::uint8_t level) {
  image::Rgb8 rgb = image::make_rgb8(width, height);
  std::fill_n(rgb.samples.get(),
              static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3,
              level);
  return image::picture_from_rgb8(rgb,
                                  {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
}

std::array<int, 3> colour_at(const image::Rgb8& picture, int x, int y) {
  const std::uint8_t* sample = picture.at(x, y);
  return {sample[0], sample[1], sample[2]};
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
  for (const auto& [x, y] : {std::pair(79, 64), {92, 64}, {85, 59}, {85, 68}}) {
    EXPECT_EQ(colour_at(result, x, y), (std::array<int, 3>{0, 230, 160})) << x << ' ' << y;
  }
}

TEST(Overlay, GivesEachIntruderItsOwnColourWhicheverOfThemAFrameHolds) {
  const image::Picture picture = grey_picture(400, 300, 100);
  annotation::Frame both = frame_with_box(0, {80, 60, 12, 8});
  both.intruders.push_back(frame_with_box(0, {280, 200, 12, 8}).intruders[0]);
  both.intruders[1].id = "c172";
  const image::Rgb8 result = overlay(picture, both, {"b737", "c172"});
  const auto first = colour_at(result, 79, 64);
  const auto second = colour_at(result, 279, 204);
  EXPECT_NE(first, second);
  both.intruders.erase(both.intruders.begin());
  EXPECT_EQ(colour_at(overlay(picture, both, {"b737", "c172"}), 279, 204), second);
}

// A label that the frame's edge cuts off paints fewer pixels than one in the middle of the picture.
TEST(Overlay, NoLabelIsCutByTheFrame) {
  const auto painted = [](const PixelBox& box) {
    const image::Picture picture = grey_picture(400, 300, 100);
    const image::Rgb8 with = overlay(picture, frame_with_box(0, box));
    int count = 0;
    for (int y = 0; y < 300; ++y)
      for (int x = 0; x < 400; ++x)
        count += colour_at(with, x, y) != std::array<int, 3>{100, 100, 100} ? 1 : 0;
    return count;
  };
  const int in_the_middle = painted({200, 150, 20, 14});
  for (const PixelBox& box : {PixelBox{3, 3, 20, 14},
                              PixelBox{377, 3, 20, 14},
                              PixelBox{3, 283, 20, 14},
                              PixelBox{377, 283, 20, 14}})
    EXPECT_EQ(painted(box), in_the_middle) << box.x << ' ' << box.y;
}

TEST(Placing, NoLabelMeetsAnotherOrLeavesTheFrameAndNoneCoversABoxWhileThereIsRoom) {
  Placing placing{{0, 0, 640, 480}, {}, {}};
  std::uint32_t state = 1;
  const auto random = [&](int below) {
    // The linear congruential generator of Numerical Recipes.
    state = state * 1664525 + 1013904223;
    return static_cast<int>((state >> 16) % static_cast<std::uint32_t>(below));
  };
  for (int i = 0; i < 40; ++i)
    placing.boxes.push_back({random(700) - 30, random(540) - 30, 4 + random(40), 4 + random(30)});
  for (const PixelBox& box : placing.boxes) {
    const auto place = place_label(box, 70, 14, placing);
    ASSERT_TRUE(place);
    EXPECT_EQ(intersection(*place, placing.frame), place);
    for (const PixelBox& other : placing.taken) EXPECT_FALSE(intersection(*place, other));
    for (const PixelBox& other : placing.boxes) EXPECT_FALSE(intersection(*place, other));
    placing.taken.push_back(*place);
  }
}

TEST(Placing, ALabelLiesOnABoxThatFillsThePictureAndNowhereInAPictureThatLabelsFill) {
  Placing placing{{0, 0, 100, 60}, {}, {{-5, -5, 110, 70}}};
  EXPECT_TRUE(place_label(placing.boxes[0], 70, 14, placing));
  placing.taken.push_back(placing.frame);
  EXPECT_FALSE(place_label(placing.boxes[0], 70, 14, placing));
  EXPECT_FALSE(place_label({10, 10, 5, 5}, 101, 14, {{0, 0, 100, 60}, {}, {}}));
}

TEST(ContactSheet, HasNoEmptyPlaceWhateverTheLength) {
  constexpr int kTile = 640 + 10;
  constexpr int kRow = 480 + 22 + 10;
  for (std::int64_t estimate : {0, 5, 40}) {
    ContactSheet sheet("name", estimate);
    for (std::int64_t i = 0; i < 40; ++i) {
      sheet.add(grey_picture(64, 48, 90), frame_with_box(i, {10, 10, 4, 4}));
      if (i > 13 && i % 9 != 0) continue;
      const image::Rgb8 picture = sheet.sheet();
      ASSERT_EQ((picture.width - 10) % kTile, 0);
      ASSERT_EQ((picture.height - 56) % kRow, 0);
      ASSERT_LE(picture.width, 10 + 3 * kTile);
      ASSERT_LE(picture.height, 56 + 4 * kRow);
      for (int y = 56; y < picture.height; y += kRow)
        for (int x = 10; x < picture.width; x += kTile)
          ASSERT_EQ(picture.at(x + 320, y + 240)[0], 90) << i + 1 << " frames";
    }
  }
  EXPECT_GT(ContactSheet("empty", 0).sheet().height, 0);
}

TEST(Tiled, PicturesOfSeveralSizesAreOurMistake) {
  std::vector<NamedPicture> pictures;
  pictures.push_back({"a", image::make_rgb8(64, 48)});
  EXPECT_GT(tiled("same", pictures, 2).width, 64);
  pictures.push_back({"b", image::make_rgb8(32, 24)});
  EXPECT_THROW(tiled("other", pictures, 2), std::logic_error);
}

TEST(Closeup, EnlargesEachPixelToASquareOfItsOwnColour) {
  const image::Picture before = grey_picture(40, 30, 50);
  const image::Picture after = grey_picture(40, 30, 60);
  const image::Rgb8 result =
      closeup({&before, &after, nullptr}, frame_with_box(3, {30, 20, 2, 2}), {5, 5, 10, 8}, 8);
  // A panel of 80 px is narrower than its caption.
  constexpr int kSlot = 110;
  EXPECT_EQ(result.width, 4 * 12 + 3 * kSlot);
  EXPECT_EQ(result.at(12 + 40, 52 + 30)[0], 50);
  // Four times the difference of 10.
  EXPECT_EQ(result.at(12 + kSlot + 12 + 40, 52 + 30)[0], 40);
  EXPECT_EQ(result.at(12 + 2 * (kSlot + 12) + 40, 52 + 30)[0], 60);
}

TEST(Closeup, IsBoundedAndShowsNoAlphaOfTheOwnAircraft) {
  const image::Picture picture = grey_picture(400, 300, 50);
  const annotation::Frame truth = frame_with_box(3, {30, 20, 2, 2});
  image::Layer layer;
  layer.patch = {10, 10, 20, 10};
  layer.pixels.assign(200, {});
  for (auto& pixel : layer.pixels) pixel.alpha = 1;
  for (std::size_t i = 0; i < 200; ++i) layer.closed.push_back(i % 20 < 10 ? 0 : 1);
  const image::Rgb8 result = closeup({&picture, &picture, &layer}, truth, {0, 0, 50, 40}, 4);
  const int alpha = 24 + (result.width - 48) / 3;
  EXPECT_EQ(result.at(alpha + 4 * 15, 52 + 4 * 15)[0], 255);
  EXPECT_EQ(result.at(alpha + 4 * 25, 52 + 4 * 15)[0], 0);
  const image::Rgb8 large = closeup({&picture, &picture, nullptr}, truth, {0, 0, 400, 300}, 64);
  EXPECT_LE(std::max(large.width, large.height), 4000);
  EXPECT_GT(large.width, 3600);
}

// A gap without ink separates the captions of two panels, and the picture's right edge has no ink.
TEST(Closeup, CaptionsDoNotRunTogetherHoweverNarrowThePanels) {
  const image::Picture picture = grey_picture(400, 300, 50);
  for (const int side : {1, 10, 24, 200}) {
    for (const int zoom : {1, 8}) {
      const image::Rgb8 result = closeup({&picture, &picture, nullptr},
                                         frame_with_box(123456, {30, 20, 2, 2}),
                                         {5, 5, side, side},
                                         zoom);
      const int slot = (result.width - 48) / 3;
      for (const int gap : {12 + slot, 24 + 2 * slot, 36 + 3 * slot})
        // Excludes the letters' rims.
        for (int x = gap + 3; x < gap + 9; ++x)
          for (int y = 26; y < 52; ++y)
            ASSERT_EQ(result.at(x, y)[0], 28) << side << ' ' << zoom << ' ' << x << ' ' << y;
      for (int y = 0; y < 26; ++y) ASSERT_EQ(result.at(result.width - 1, y)[0], 28) << side;
    }
  }
}

// OpenCV's imgcodecs writes the JPEG and decodes it once more, as an independent answer.
TEST(Boxed, HasThePixelsThatOpenCvDecodes) {
  cv::Mat picture(48, 64, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      picture.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<std::uint8_t>(4 * x),
                                              static_cast<std::uint8_t>(5 * y),
                                              static_cast<std::uint8_t>(2 * (x + y)));
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(cv::imencode(".jpg", picture, bytes));
  const image::Rgb8 decoded = boxed(std::string(bytes.begin(), bytes.end()), 1, {});
  cv::Mat expected;
  cv::cvtColor(cv::imdecode(bytes, cv::IMREAD_COLOR), expected, cv::COLOR_BGR2RGB);
  ASSERT_EQ(decoded.width, 64);
  ASSERT_EQ(decoded.height, 48);
  for (int y = 0; y < decoded.height; ++y)
    for (int x = 0; x < decoded.width; ++x) {
      const auto& pixel = expected.at<cv::Vec3b>(y, x);
      ASSERT_EQ(colour_at(decoded, x, y), (std::array<int, 3>{pixel[0], pixel[1], pixel[2]}))
          << "at " << x << ", " << y;
    }
}

TEST(Boxed, RefusesWhatIsNoPicture) { EXPECT_THROW(boxed("no JPEG", 1, {}), Error); }

}  // namespace
}  // namespace airtruth::drawing
