// SPDX-License-Identifier: Apache-2.0
#include "calibration/edges.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "image/colour.h"

namespace airtruth::calibration {
namespace {

constexpr double kSpreadPx = 1.0;

// A step through a Gaussian and two pixels: what is drawn has whole pixels, and so has the spread.
double step(double place_px) {
  constexpr int kPlaces = 4;
  double sum = 0;
  for (int i = 0; i < kPlaces; ++i)
    for (int j = 0; j < kPlaces; ++j) {
      const double at = place_px + (i + j + 1.0) / kPlaces - 1;
      sum += 0.5 * (1 + std::erf(at / (kSpreadPx * std::sqrt(2.0))));
    }
  return sum / (kPlaces * kPlaces);
}

// Slanted bars; along half of their edges lies a line on the dark side.
image::Picture bars(double line_depth, double shift_px) {
  constexpr int kWidth = 640, kHeight = 200, kFine = 20;
  constexpr int kMost = 60;  // px from the edge that anything is seen of it
  std::vector<double> rise;  // of one edge's light and of its line, kFine places a pixel
  std::vector<double> line;
  for (int i = -kMost * kFine; i <= kMost * kFine; ++i) {
    const double place = double(i) / kFine;
    rise.push_back(step(place));
    line.push_back(step(place + 2.3) - step(place + 0.8));
  }
  image::Picture picture = image::make_picture(kWidth, kHeight, {});
  const image::ColourCode code(picture.colour);
  const double dark = double(code.ycc_from_rgb({0, 0, 0}).y);
  const double unit = double(code.ycc_from_rgb({1, 1, 1}).y) - dark;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      double light = 0;
      for (int edge = 0; edge < 12; ++edge) {
        const double across = (x - 20.0 - shift_px - 50 * edge) * std::cos(0.1) + y * std::sin(0.1);
        const bool rises = edge % 2 == 0;
        const double towards_light =
            std::clamp(rises ? across : -across, -1.0 * kMost, 1.0 * kMost);
        const auto i = static_cast<std::size_t>(std::lround((towards_light + kMost) * kFine));
        light += rises ? rise[i] : rise[i] - 1;
        if (edge % 4 < 2) light -= line_depth * line[i];
      }
      const double linear = 0.25 + 0.25 * light;
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(
          dark + unit * double(image::srgb_from_linear(static_cast<float>(linear))) + 0.5);
    }
  return picture;
}

StepResponse measured(double line_depth) {
  EdgeMeter meter(nullptr, {});
  for (const double shift_px : {0.0, 1.3, 2.6, 3.9, 5.2, 6.5})
    meter.add(bars(line_depth, shift_px), std::nullopt);
  std::string why;
  const auto found = meter.result(why);
  EXPECT_TRUE(found) << why;
  return found.value_or(StepResponse{});
}

TEST(Edges, SpreadOfCleanOnes) {
  const StepResponse found = measured(0);
  EXPECT_NEAR(found.point_spread_px.value, kSpreadPx, 0.05);
  EXPECT_LT(found.sharpening.value, 0.05);
}

TEST(Edges, LinesAlongSomeOfThemAreNoSharpening) {
  const StepResponse found = measured(0.15);
  EXPECT_NEAR(found.point_spread_px.value, kSpreadPx, 0.05);
  EXPECT_LT(found.sharpening.value, 0.05);
}

TEST(Edges, NoneIsNoAnswer) {
  EdgeMeter meter(nullptr, {});
  image::Picture grey = image::make_picture(320, 240, {});
  for (int y = 0; y < 240; ++y) std::fill_n(grey.planes[0].row(y), 320, std::uint8_t{128});
  meter.add(grey, std::nullopt);
  std::string why;
  EXPECT_FALSE(meter.result(why));
  EXPECT_EQ(why, "the clip shows 0 clean straight edges; it takes 12");
}

// From 10 to 90 % a Gaussian takes 2.5631 of its standard deviations.
TEST(StepResponse, SpreadOfAnEdgeIsTheGaussians) {
  for (const double sigma : {0.8, 1.5}) {
    const double found = edge_spread_px({{sigma, 0}, {0, 0}, {1, 0}}, 0.5, 0.505, {});
    EXPECT_NEAR(found, 2.5631 * std::sqrt(sigma * sigma + 1.0 / 6), 0.03);
  }
}

}  // namespace
}  // namespace airtruth::calibration
