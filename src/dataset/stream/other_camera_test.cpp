// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/other_camera.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace airtruth::stream {
namespace {

using image::Picture;

// Luma by place; grey chroma.
Picture picture_of(int width,
                   int height,
                   const std::function<double(int x, int y)>& luma,
                   const image::Colour& colour = {}) {
  Picture picture = image::make_picture(width, height, colour);
  for (int i = 0; i < picture.plane_count; ++i) {
    image::Plane& plane = picture.planes[static_cast<std::size_t>(i)];
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x)
        plane.row(y)[x] = static_cast<std::uint8_t>(i == 0 ? std::lround(luma(x, y)) : 128);
  }
  return picture;
}

struct Spread {
  double mean = 0;
  double deviation = 0;
};
Spread spread_of(const std::vector<double>& values) {
  Spread result;
  for (const double value : values) result.mean += value / static_cast<double>(values.size());
  for (const double value : values)
    result.deviation += (value - result.mean) * (value - result.mean);
  result.deviation = std::sqrt(result.deviation / static_cast<double>(values.size()));
  return result;
}

Spread luma_spread(const Picture& picture) {
  std::vector<double> values;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) values.push_back(picture.luma().row(y)[x]);
  return spread_of(values);
}

TEST(OtherCamera, ThatAddsNothingChangesNothing) {
  const Picture ramp = picture_of(64, 48, [](int x, int y) { return 16 + x + 2 * y; });
  EXPECT_TRUE(image::identical(ramp, seen_through({}, ramp, 1)));
}

// The derivative of a step is the kernel: a Gaussian over pixels, of variance sigma^2 + 1/12.
TEST(OtherCamera, AStepIsAsSoftAsItsSpread) {
  const Picture step = picture_of(64, 16, [](int x, int) { return x < 32 ? 20 : 220; });
  for (const double sigma : {0.5, 0.8, 1.5}) {
    const Picture shown = seen_through({.spread_px = sigma}, step, 1);
    double sum = 0, variance = 0;
    for (int x = 1; x < 64; ++x) {
      const double rise = shown.luma().row(8)[x] - shown.luma().row(8)[x - 1];
      sum += rise;
      variance += rise * (x - 32) * (x - 32);
    }
    EXPECT_NEAR(sum, 200, 1e-9);
    EXPECT_NEAR(variance / sum, sigma * sigma + 1.0 / 12, 0.08 * sigma * sigma) << sigma;
  }
}

TEST(OtherCamera, AnEvenPictureStaysEvenToItsRim) {
  const Picture even = picture_of(33, 17, [](int, int) { return 140; });
  const Picture shown =
      seen_through({.spread_px = 2, .sharpening = 0.7, .chroma_spread_px = 3}, even, 1);
  EXPECT_TRUE(image::identical(even, shown));
}

TEST(OtherCamera, SharpeningOvershootsAStep) {
  const Picture step = picture_of(64, 16, [](int x, int) { return x < 32 ? 80 : 160; });
  const Picture shown = seen_through({.sharpening = 0.5}, step, 1);
  // A Gaussian of one pixel takes 1 - Phi(1/2) of the step from the pixel beside it.
  EXPECT_NEAR(shown.luma().row(8)[32] - 160, 0.5 * 0.3085 * 80, 1);
  EXPECT_NEAR(80 - shown.luma().row(8)[31], 0.5 * 0.3085 * 80, 1);
  EXPECT_EQ(shown.luma().row(8)[60], 160);
}

TEST(OtherCamera, ToneIsAPowerAndAFactorClippedAtTheBrightest) {
  const Picture ramp = picture_of(220, 2, [](int x, int) { return 16 + x; });
  const Picture shown = seen_through({.gamma = 1.2, .gain = 1.1}, ramp, 1);
  for (int x = 0; x < 220; ++x)
    EXPECT_NEAR(
        shown.luma().row(0)[x], 16 + 219 * std::min(1.0, 1.1 * std::pow(x / 219.0, 1.2)), 0.51);
}

TEST(OtherCamera, NoiseHasItsDeviationAndGrowsWithLight) {
  const OtherCamera camera{.noise = 0.02};
  for (const double light : {0.5, 0.125}) {
    const Picture even = picture_of(200, 200, [&](int, int) { return 16 + 219 * light; });
    const Picture shown = seen_through(camera, even, 5);
    const double expected = std::hypot(0.02 * 219 * std::sqrt(2 * light), 1 / std::sqrt(12));
    EXPECT_NEAR(luma_spread(shown).deviation, expected, 0.03 * expected) << light;
    EXPECT_NEAR(luma_spread(shown).mean, luma_spread(even).mean, 0.1);
    EXPECT_TRUE(image::identical(shown, seen_through(camera, even, 5)));
    EXPECT_FALSE(image::identical(shown, seen_through(camera, even, 6)));
  }
}

TEST(OtherCamera, ColourIsScaledAboutGreyAndTinted) {
  Picture red = picture_of(32, 32, [](int, int) { return 120; });
  for (int y = 0; y < 16; ++y) {
    std::fill_n(red.planes[1].row(y), 16, 100);
    std::fill_n(red.planes[2].row(y), 16, 200);
  }
  const Picture shown = seen_through({.saturation = 0.5, .tint = {4, -3}}, red, 1);
  EXPECT_EQ(shown.planes[0].row(3)[3], 120);
  EXPECT_EQ(shown.planes[1].row(3)[3], 128 - 14 + 4);
  EXPECT_EQ(shown.planes[2].row(3)[3], 128 + 36 - 3);
}

// Halved in one direction alone: in pixels of luma a spot's chroma is as wide as it is high.
TEST(OtherCamera, ChromaIsSpreadInPixelsOfLuma) {
  Picture spot = picture_of(64, 64, [](int, int) { return 120; }, {image::Chroma::k422});
  for (int y = 30; y < 34; ++y) std::fill_n(spot.planes[2].row(y) + 15, 2, 228);
  const Picture shown = seen_through({.chroma_spread_px = 3}, spot, 1);
  double sum = 0, across = 0, down = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 32; ++x) {
      const double red = shown.planes[2].row(y)[x] - 128;
      sum += red;
      across += red * std::pow(2 * x + 1 - 32, 2);
      down += red * std::pow(y + 0.5 - 32, 2);
    }
  EXPECT_NEAR(across / sum, down / sum, 0.15 * down / sum);
}

TEST(OtherCamera, ACoarserQuantiserLosesMore) {
  const auto waves = [](int x, int y) {
    return 120 + 40 * std::sin(0.7 * x) * std::sin(0.9 * y) + 20 * std::sin(0.05 * x * y);
  };
  const Picture picture = picture_of(96, 64, waves);
  const auto lost = [&](int quantiser) {
    const Picture shown = seen_through({.quantiser = quantiser}, picture, 1);
    double sum = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x)
        sum += std::abs(shown.luma().row(y)[x] - picture.luma().row(y)[x]) / (96.0 * 64);
    return sum;
  };
  EXPECT_GT(lost(18), 0.1);
  EXPECT_LT(lost(18), 3);
  EXPECT_GT(lost(36), 2 * lost(18));
}

TEST(OtherCamera, PicturesOfAnyLayoutAndSizeAreShown) {
  const OtherCamera camera{.spread_px = 0.6, .noise = 0.01, .sharpening = 0.3, .quantiser = 30};
  for (const image::Chroma chroma : {image::Chroma::kNone,
                                     image::Chroma::k420,
                                     image::Chroma::k422,
                                     image::Chroma::k440,
                                     image::Chroma::k444})
    for (const auto& [width, height] : {std::pair{64, 48}, {65, 47}, {16, 16}, {1, 1}, {1, 9}}) {
      const Picture picture =
          picture_of(width, height, [](int x, int y) { return 60 + x + y; }, {chroma});
      const Picture shown = seen_through(camera, picture, 1);
      EXPECT_EQ(shown.width, width);
      EXPECT_EQ(shown.colour, picture.colour);
      EXPECT_FALSE(image::identical(shown, picture));
    }
  const Picture planes =
      picture_of(32,
                 32,
                 [](int, int) { return 200; },
                 {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  const Picture shown = seen_through({.gain = 0.5}, planes, 1);
  EXPECT_EQ(shown.planes[0].row(0)[0], 100);
  EXPECT_EQ(shown.planes[1].row(0)[0], 64);
}

// Noise of luma is the same in red, green and blue.
TEST(OtherCamera, NoiseLeavesGreyPlanesOfRedGreenAndBlueGrey) {
  const Picture grey = picture_of(32,
                                  32,
                                  [](int, int) { return 128; },
                                  {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  const Picture shown = seen_through({.noise = 0.02}, grey, 3);
  EXPECT_FALSE(image::identical(shown, grey));
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      ASSERT_EQ(shown.planes[1].row(y)[x], shown.planes[0].row(y)[x]);
      ASSERT_EQ(shown.planes[2].row(y)[x], shown.planes[0].row(y)[x]);
    }
}

TEST(OtherCamera, CamerasDifferAndAreThoseOfTheirSeed) {
  const OtherCamera a = drawn_camera(Random(1)), b = drawn_camera(Random(2));
  EXPECT_NE(a.spread_px, b.spread_px);
  EXPECT_EQ(a.noise, drawn_camera(Random(1)).noise);
  int coded = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const OtherCamera camera = drawn_camera(Seed(3).stream("camera", i));
    coded += camera.quantiser > 0;
    EXPECT_TRUE(camera.quantiser == 0 || (camera.quantiser >= 18 && camera.quantiser < 37));
  }
  EXPECT_NEAR(coded, 700, 60);
}

}  // namespace
}  // namespace airtruth::stream
