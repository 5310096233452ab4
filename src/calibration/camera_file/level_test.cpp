// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/level.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "foundation/image/colour.h"

namespace airtruth::camera_file {
namespace {

// Of an overexposed sky and of a blue one, over the lower half of the picture that is ground.
TEST(TintedSky, IsRedderThanItWasWhateverItsColour) {
  const lens::ImageSize size{32, 24};
  const lens::Lens lens = lens::pinhole_from_vertical_fov(60, size);
  for (const bool is_blue : {false, true}) {
    image::Rgb8 sky = image::make_rgb8(size.width, size.height);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        std::uint8_t* p = sky.at(x, y);
        p[0] = is_blue ? 199 : 255;
        p[1] = is_blue ? 206 : 255;
        p[2] = is_blue ? 228 : 255;
      }
    std::vector<SampledFrame> frames;
    frames.push_back({image::picture_from_rgb8(sky, {}), 0, {}});
    const image::Rgb8 plain = image::rgb8_from_picture(frames[0].picture);
    const auto tinted = tinted_sky(lens, frames, {horizon::HorizonEdge{}});
    ASSERT_TRUE(tinted);
    for (int y = 0; y < size.height; ++y) {
      const std::uint8_t* before = plain.at(5, y);
      const std::uint8_t* after = tinted->at(5, y);
      const int redder =
          (after[0] - before[0]) - std::max(after[1] - before[1], after[2] - before[2]);
      if (y < size.height / 2)
        EXPECT_GT(redder, 40) << y;
      else
        EXPECT_EQ(redder, 0) << y;
    }
  }
}

}  // namespace
}  // namespace airtruth::camera_file
