// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/contrast_to_noise.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "foundation/base/seed.h"

namespace airtruth::image {
namespace {

// A grey sky of level 120 with noise.
Picture sky(double noise, int width = 200, int height = 160) {
  Picture picture = make_picture(width, height, {Chroma::kNone});
  Random random(7);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture.planes[0].row(y)[x] =
          static_cast<std::uint8_t>(std::lround(120 + noise * random.normal()));
  return picture;
}

void darken(Picture& picture, const PixelBox& box, int by) {
  for (int y = box.y; y < box.bottom(); ++y)
    for (int x = box.x; x < box.right(); ++x)
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(picture.planes[0].row(y)[x] - by);
}

TEST(ContrastToNoise, IsTheContrastOverTheNoise) {
  Picture picture = sky(2);
  const PixelBox box{80, 60, 24, 16};
  darken(picture, box, 20);
  // The noise of the box itself adds in squares.
  EXPECT_NEAR(*contrast_to_noise(picture, box), std::hypot(20, 2) / 2, 0.3);
  // Half of the box filled: sqrt(1 / 2) of it.
  const PixelBox half{80, 60, 48, 16};
  EXPECT_NEAR(*contrast_to_noise(picture, half), std::hypot(20 / std::sqrt(2.0), 2) / 2, 0.3);
}

TEST(ContrastToNoise, OfRedGreenAndBlueItIsThatOfLuma) {
  Picture picture = make_picture(60, 60, {Chroma::k444, Matrix::kRgb, Range::kFull});
  for (Plane& plane : picture.planes)
    for (int y = 0; y < 60; ++y) std::fill_n(plane.row(y), 60, std::uint8_t{120});
  for (int y = 20; y < 30; ++y) std::fill_n(picture.planes[2].row(y) + 20, 12, std::uint8_t{20});
  EXPECT_NEAR(contrast(picture, {20, 20, 12, 10}), 30, 0.5);  // 0.299 of 100
  EXPECT_NEAR(*contrast_to_noise(picture, {20, 20, 12, 10}), 30 * std::sqrt(12.0), 2);
}

TEST(ContrastToNoise, NothingHasAboutOne) {
  const Picture picture = sky(3);
  EXPECT_NEAR(*contrast_to_noise(picture, {50, 50, 30, 30}), 1, 0.1);
}

TEST(ContrastToNoise, WithoutNoiseItIsThatOfRounding) {
  Picture picture = sky(0);
  EXPECT_EQ(*contrast_to_noise(picture, {50, 50, 6, 3}), 0);
  darken(picture, {50, 50, 6, 3}, 1);
  EXPECT_NEAR(*contrast_to_noise(picture, {50, 50, 6, 3}), std::sqrt(12.0), 1e-12);
}

TEST(ContrastToNoise, AnotherObjectInTheRingIsNoNoise) {
  Picture picture = sky(2);
  const PixelBox box{80, 60, 12, 8};
  darken(picture, box, 20);
  const double alone = *contrast_to_noise(picture, box);
  darken(picture, {95, 60, 3, 3}, 60);
  EXPECT_NEAR(*contrast_to_noise(picture, box), alone, 0.25 * alone);
}

TEST(ContrastToNoise, TheEdgeOfThePictureCutsTheRing) {
  const Picture picture = sky(2);
  EXPECT_TRUE(contrast_to_noise(picture, {0, 0, 5, 5}));
  EXPECT_TRUE(contrast_to_noise(picture, {-3, -3, 8, 8}));
  EXPECT_FALSE(contrast_to_noise(picture, {0, 0, 200, 160}));
  EXPECT_FALSE(contrast_to_noise(picture, {300, 0, 5, 5}));
}

}  // namespace
}  // namespace airtruth::image
