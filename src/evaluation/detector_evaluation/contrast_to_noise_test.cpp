// SPDX-License-Identifier: Apache-2.0
#include "evaluation/detector_evaluation/contrast_to_noise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "encounter/separation/violation.h"
#include "evaluation/detector_evaluation/set_truth.h"
#include "foundation/base/seed.h"

namespace airtruth::detector_evaluation {
namespace {

// A grey sky of level 120 with noise.
image::Picture sky(double noise, int width = 200, int height = 160) {
  image::Picture picture = image::make_picture(width, height, {image::Chroma::kNone});
  Random random(7);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture.planes[0].row(y)[x] =
          static_cast<std::uint8_t>(std::lround(120 + noise * random.normal()));
  return picture;
}

void darken(image::Picture& picture, const PixelBox& box, int by) {
  for (int y = box.y; y < box.bottom(); ++y)
    for (int x = box.x; x < box.right(); ++x)
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(picture.planes[0].row(y)[x] - by);
}

TEST(ContrastToNoise, IsTheContrastOverTheNoise) {
  image::Picture picture = sky(2);
  const PixelBox box{80, 60, 24, 16};
  darken(picture, box, 20);
  // The noise of the box itself adds in squares.
  EXPECT_NEAR(*contrast_to_noise(picture, box), std::hypot(20, 2) / 2, 0.3);
  // Half of the box filled: sqrt(1 / 2) of it.
  const PixelBox half{80, 60, 48, 16};
  EXPECT_NEAR(*contrast_to_noise(picture, half), std::hypot(20 / std::sqrt(2.0), 2) / 2, 0.3);
}

TEST(ContrastToNoise, NothingHasAboutOne) {
  const image::Picture picture = sky(3);
  EXPECT_NEAR(*contrast_to_noise(picture, {50, 50, 30, 30}), 1, 0.1);
}

TEST(ContrastToNoise, WithoutNoiseItIsThatOfRounding) {
  image::Picture picture = sky(0);
  EXPECT_EQ(*contrast_to_noise(picture, {50, 50, 6, 3}), 0);
  darken(picture, {50, 50, 6, 3}, 1);
  EXPECT_NEAR(*contrast_to_noise(picture, {50, 50, 6, 3}), std::sqrt(12.0), 1e-12);
}

TEST(ContrastToNoise, AnotherObjectInTheRingIsNoNoise) {
  image::Picture picture = sky(2);
  const PixelBox box{80, 60, 12, 8};
  darken(picture, box, 20);
  const double alone = *contrast_to_noise(picture, box);
  darken(picture, {95, 60, 3, 3}, 60);
  EXPECT_NEAR(*contrast_to_noise(picture, box), alone, 0.25 * alone);
}

TEST(ContrastToNoise, TheEdgeOfThePictureCutsTheRing) {
  const image::Picture picture = sky(2);
  EXPECT_TRUE(contrast_to_noise(picture, {0, 0, 5, 5}));
  EXPECT_TRUE(contrast_to_noise(picture, {-3, -3, 8, 8}));
  EXPECT_FALSE(contrast_to_noise(picture, {0, 0, 200, 160}));
  EXPECT_FALSE(contrast_to_noise(picture, {300, 0, 5, 5}));
}

// A head-on pair in uniform motion, sampled at 10 Hz from `first_s` to `last_s`.
std::vector<PairState> head_on(double first_s, double last_s) {
  std::vector<PairState> states;
  for (int i = 0; first_s + 0.1 * i <= last_s + 1e-9; ++i) {
    const double t = first_s + 0.1 * i;
    states.push_back({t,
                      {Vector3(30 * t, 0, -150), Vector3(30, 0, 0)},
                      {Vector3(3000 - 60 * t, 100, -170), Vector3(-60, 0, 0)}});
  }
  return states;
}

TEST(FirstViolation, IsThatOfTheClosedFormWithinTheFramesAndAfterThem) {
  const separation::Volume& volume = separation::named_volume("f3442")->volume;
  const std::vector<PairState> begin = head_on(0, 0);
  const double exact_s =
      separation::violation(volume, begin[0].own, begin[0].intruder, 180)->begin_s;
  EXPECT_NEAR(*first_violation_s(volume, head_on(0, 40), 180), exact_s, 1e-9);
  EXPECT_NEAR(*first_violation_s(volume, head_on(0, 5), 180), exact_s, 1e-9);
  EXPECT_FALSE(first_violation_s(volume, head_on(0, 5), 1));
  EXPECT_NEAR(*first_violation_s(volume, head_on(30, 31), 180), 30, 1e-12);
  EXPECT_FALSE(first_violation_s(volume, {}, 180));
}

}  // namespace
}  // namespace airtruth::detector_evaluation
