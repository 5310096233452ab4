// SPDX-License-Identifier: Apache-2.0
#include "comparison/appearance/background_shift.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "foundation/base/seed.h"

namespace airtruth::appearance {
namespace {

TEST(BackgroundShift, IsFoundWithoutTheAircraft) {
  Random random(5);
  cv::Mat ground(400, 500, CV_32F);
  for (int i = 0; i < ground.rows * ground.cols; ++i)
    ground.ptr<float>(0)[i] = static_cast<float>(128 + 25 * random.normal());
  const auto frame = [&](int x0, int y0, int aircraft_x) {
    image::Picture picture = image::make_picture(320, 240, {image::Chroma::kNone});
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x)
        picture.planes[0].row(y)[x] =
            std::abs(x - aircraft_x) < 20 && std::abs(y - 100) < 6
                ? std::uint8_t{10}
                : static_cast<std::uint8_t>(
                      std::clamp(double(ground.at<float>(y + y0, x + x0)), 0.0, 255.0));
    return picture;
  };
  BackgroundShift shift;
  EXPECT_FALSE(shift.add(frame(20, 20, 100), {{80, 94, 40, 12}}));
  const auto found = shift.add(frame(26, 16, 130), {{110, 94, 40, 12}});
  ASSERT_TRUE(found);  // the camera looks 6 px to the right: the ground goes 6 px to the left
  EXPECT_NEAR(found->x(), -6, 0.3);
  EXPECT_NEAR(found->y(), 4, 0.3);
  // A sky without anything in it says nothing.
  BackgroundShift blank;
  const image::Picture sky = image::make_picture(64, 64, {image::Chroma::kNone});
  std::fill_n(sky.planes[0].samples.get(), sky.planes[0].stride * 64, std::uint8_t{90});
  blank.add(sky, {});
  EXPECT_FALSE(blank.add(sky, {}));
}

}  // namespace
}  // namespace airtruth::appearance
