// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/edges.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "foundation/base/seed.h"
#include "foundation/image/colour.h"
#include "foundation/image/mats.h"
#include "picture/video/patch_codec.h"

namespace airtruth::optics {
namespace {

constexpr double kSpreadPx = 1.0;

// A step through a Gaussian and two boxes of a pixel: the light is that of whole pixels, and so is
// the spread.
double step(double place_px, double spread_px = kSpreadPx) {
  constexpr int kPlaces = 4;
  double sum = 0;
  for (int i = 0; i < kPlaces; ++i)
    for (int j = 0; j < kPlaces; ++j) {
      const double at = place_px + (i + j + 1.0) / kPlaces - 1;
      sum += 0.5 * (1 + std::erf(at / (spread_px * std::sqrt(2.0))));
    }
  return sum / (kPlaces * kPlaces);
}

// A picture of slanted bars. Half of their edges have a line on the dark side.
image::Picture bars(double line_depth, double shift_px, double contrast = 0.25) {
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
  Random noise(7);  // as cameras have it: without, all edges are rounded alike
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
      const double linear = 0.25 + contrast * light;
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(
          dark + unit * double(image::srgb_from_linear(static_cast<float>(linear))) +
          noise.uniform(0, 1));
    }
  return picture;
}

StepResponse measured(double line_depth) {
  EdgeMeter meter(nullptr, {});
  for (const double shift_px : {0.0, 1.3, 2.6, 3.9, 5.2, 6.5})
    meter.add(bars(line_depth, shift_px), std::nullopt);
  const auto found = meter.result();
  EXPECT_TRUE(found) << found.why();
  return found ? *found : StepResponse{};
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

// White of 16 to 235 is 235.
TEST(Edges, OverexposedOnesAreNone) {
  EdgeMeter meter(nullptr, {});
  for (const double shift_px : {0.0, 1.3, 2.6}) meter.add(bars(0, shift_px, 1.0), std::nullopt);
  EXPECT_EQ(meter.result().why(), "the clip shows 0 clean straight edges; it takes 12");
}

// OpenCV blurs along the columns alone.
TEST(Edges, SofterAlongTheColumns) {
  for (const double beyond_px : {0.0, 0.8}) {
    EdgeMeter meter(nullptr, {});
    for (const double shift_px : {0.0, 1.3, 2.6, 3.9, 5.2, 6.5})
      for (const bool is_turned : {false, true}) {
        const image::Picture sharp = bars(0, shift_px);
        cv::Mat grey = image::luma_of(sharp).clone();  // a Mat of luma is of the picture's samples
        if (is_turned) cv::transpose(grey, grey);
        if (beyond_px > 0) cv::GaussianBlur(grey, grey, {1, 15}, 1e-3, beyond_px);
        image::Picture picture = image::make_picture(grey.cols, grey.rows, {});
        for (int y = 0; y < grey.rows; ++y)
          std::copy_n(grey.ptr<std::uint8_t>(y), grey.cols, picture.planes[0].row(y));
        meter.add(picture, std::nullopt);
      }
    const auto found = meter.result();
    ASSERT_TRUE(found) << found.why();
    EXPECT_NEAR(found->point_spread_px.value, kSpreadPx, 0.05);
    ASSERT_TRUE(found->vertical_spread_px) << found->vertical_spread_px.why();
    EXPECT_NEAR(found->vertical_spread_px->value, beyond_px, 0.05);
  }
}

TEST(Edges, AlongTheColumnsAloneSayNothingOfTheDifference) {
  EdgeMeter meter(nullptr, {});
  for (const double shift_px : {0.0, 1.3, 2.6}) meter.add(bars(0, shift_px), std::nullopt);
  EXPECT_EQ(meter.result()->vertical_spread_px.why(),
            "the clip shows 0 clean edges along its rows and 100 along its columns; it takes 12 of "
            "each");
}

// Cb crosses the same edge as luma through a wider Gaussian, whatever the sharpness of luma is.
TEST(Edges, ChromaThatIsSofterThanLuma) {
  for (const double beyond_px : {1.5, 3.0}) {
    EdgeMeter meter(nullptr, {});
    Random noise(3);
    for (const double shift_px : {0.0, 1.3, 2.6, 3.9, 5.2, 6.5}) {
      image::Picture picture = bars(0, shift_px);
      // Light and luma's spread are of whole pixels each, the Gaussian beyond of whole samples, and
      // a sample on a column is the mean of a quarter, a half and a quarter of three.
      const double grids_px2 = 1.0 / 12 + 1.0 / 12 + 4.0 / 12 + 0.5;
      const double spread_px = std::hypot(kSpreadPx, beyond_px, std::sqrt(grids_px2));
      // Siting: left, on the block's first column and between its rows.
      for (int cy = 0; cy < picture.planes[1].height; ++cy)
        for (int cx = 0; cx < picture.planes[1].width; ++cx) {
          double height = 0;
          for (int edge = 0; edge < 12; ++edge) {
            const double across = (2 * cx - 20.0 - shift_px - 50 * edge) * std::cos(0.1) +
                                  (2 * cy + 0.5) * std::sin(0.1);
            const double risen = 0.5 * (1 + std::erf(across / (spread_px * std::sqrt(2.0))));
            height += edge % 2 == 0 ? risen : -risen;
          }
          picture.planes[1].row(cy)[cx] =
              static_cast<std::uint8_t>(110 + 24 * height + noise.uniform(0, 1));
        }
      meter.add(picture, std::nullopt);
    }
    const auto luma = meter.result();
    ASSERT_TRUE(luma) << luma.why();
    const auto found = meter.chroma(*luma);
    ASSERT_TRUE(found) << found.why();
    std::printf(
        "chroma beyond luma: %.2f +- %.2f px (%.2f)\n", found->value, found->sigma, beyond_px);
    EXPECT_NEAR(found->value, beyond_px, 0.1 * beyond_px);
  }
}

TEST(Edges, WithoutColourSayNothingOfChroma) {
  EdgeMeter meter(nullptr, {});
  for (const double shift_px : {0.0, 1.3}) {
    image::Picture picture = bars(0, shift_px);
    for (const std::size_t p : {1U, 2U})
      for (int y = 0; y < picture.planes[p].height; ++y)
        std::fill_n(picture.planes[p].row(y), picture.planes[p].width, std::uint8_t{128});
    meter.add(picture, std::nullopt);
  }
  const auto luma = meter.result();
  ASSERT_TRUE(luma) << luma.why();
  EXPECT_EQ(meter.chroma(*luma).why(),
            "the clip shows 0 sharp edges with a clean step of colour; it takes 12");
}

// An edge that does not move, such as one of the own aircraft, counts once in ten frames.
TEST(Edges, ThatStayWhereTheyAreAreOne) {
  EdgeMeter meter(nullptr, {});
  for (int frame = 0; frame < 10; ++frame) meter.add(bars(0, 0), std::nullopt);
  EdgeMeter once(nullptr, {});
  once.add(bars(0, 0), std::nullopt);
  ASSERT_TRUE(meter.result());
  ASSERT_TRUE(once.result());
  EXPECT_GT(once.profile().edges, 10);
  EXPECT_EQ(meter.profile().edges, once.profile().edges);
}

// High and low edges of equal sharpness pass through a real encoder, which softens the low ones.
TEST(Edges, ThatACodecSoftenedGiveWayToThoseThatStandOutFromItsStep) {
  constexpr int kQuantiser = 27;
  constexpr double kStep = 14.14;  // 0.625 * 2^(27/6)
  video::PatchCodec codec(kQuantiser);
  image::Picture grey = image::make_picture(640, 400, {});
  for (const image::Plane& plane : grey.planes)
    std::fill_n(plane.samples.get(), plane.stride * plane.height, std::uint8_t{128});
  EdgeMeter meter(nullptr, {});
  for (const double shift_px : {0.0, 1.3, 2.6, 3.9, 5.2, 6.5}) {
    image::Picture frame = grey.clone();
    image::paste(frame, bars(0, shift_px, 0.7), 0, 0);
    image::paste(frame, bars(0, shift_px, 0.18), 0, 200);
    for (const std::size_t p : {1u, 2u})
      std::fill_n(frame.planes[p].samples.get(),
                  frame.planes[p].stride * frame.planes[p].height,
                  std::uint8_t{128});
    meter.add(codec.coded(frame, grey), std::nullopt);
  }
  const auto all = meter.result();
  const auto clear = meter.result(kStep);
  ASSERT_TRUE(all && clear) << all.why() << clear.why();
  EXPECT_NEAR(clear->point_spread_px.value, kSpreadPx, 0.05);
  EXPECT_GT(std::abs(all->point_spread_px.value - kSpreadPx),
            std::abs(clear->point_spread_px.value - kSpreadPx));
}

TEST(Edges, NoneIsNoAnswer) {
  EdgeMeter meter(nullptr, {});
  image::Picture grey = image::make_picture(320, 240, {});
  for (int y = 0; y < 240; ++y) std::fill_n(grey.planes[0].row(y), 320, std::uint8_t{128});
  meter.add(grey, std::nullopt);
  EXPECT_EQ(meter.result().why(), "the clip shows 0 clean straight edges; it takes 12");
}

// Edges of different softness in the world, some with lines along them, through an unsharp mask.
// All values are computed by sums, independently of the model that is fitted.
std::vector<StepEdge> masked_edges(double spread_px, double amount, double radius_px) {
  constexpr double kLow = 0.35, kHigh = 0.6, kFine = 0.1;
  std::vector<StepEdge> edges;
  for (int e = 0; e < 40; ++e) {
    const double softness_px = e % 4 == 0 ? 0.05 : 0.2 * (e % 5);
    const double own_px = std::hypot(spread_px, softness_px);
    const double line = e % 8 == 3 ? 0.15 : 0;
    const auto coded = [&](double place) {
      const auto linear = [](double v) {
        return double(image::linear_from_srgb(static_cast<float>(v)));
      };
      const double dark = linear(kLow), bright = linear(kHigh);
      const double height =
          step(place, own_px) - line * (step(place + 2.3, own_px) - step(place + 0.8, own_px));
      return double(image::srgb_from_linear(static_cast<float>(dark + (bright - dark) * height)));
    };
    StepEdge edge{kLow, kHigh, {}};
    for (double place = -5.9 + 0.01 * e; place < 6; place += 0.23) {
      double soft = 0, total = 0;
      for (double off = -5 * radius_px; off <= 5 * radius_px; off += kFine) {
        const auto below = [&](double x) { return std::erf(x / (radius_px * std::sqrt(2.0))); };
        const double weight = below(off + 0.5) - below(off - 0.5);
        soft += weight * coded(place + off), total += weight;
      }
      const double sharp = coded(place);
      const double value = sharp + amount * (sharp - soft / total);
      const double noise = 0.003 * std::sin(1000 * place + 17 * e);
      edge.samples.push_back({place, (value - kLow) / (kHigh - kLow) + noise});
    }
    edges.push_back(std::move(edge));
  }
  return edges;
}

TEST(StepResponse, OfEdgesThatAreSofterThanSteps) {
  struct Case {
    double spread_px, amount, radius_px;
  };
  for (const Case& c : {Case{0.8, 0, 1}, Case{1.3, 0, 1}, Case{0.8, 0.8, 1.2}, Case{0.6, 1.2, 1}}) {
    const std::vector<StepEdge> edges = masked_edges(c.spread_px, c.amount, c.radius_px);
    std::vector<const StepEdge*> all;
    for (const StepEdge& edge : edges) all.push_back(&edge);
    const StepResponse found = fit_step_response(all, {});
    EXPECT_NEAR(found.point_spread_px.value, c.spread_px, 0.05 * c.spread_px);
    EXPECT_NEAR(found.sharpening.value, c.amount, 0.1 * c.amount + 1e-9);
    if (c.amount > 0) {
      EXPECT_NEAR(found.sharpening_px.value, c.radius_px, 0.1 * c.radius_px);
    }
    const double truth_px =
        edge_spread_px({{c.spread_px, 0}, {c.amount, 0}, {c.radius_px, 0}}, 0.4, 0.6, {});
    EXPECT_NEAR(edge_spread_px(found, 0.4, 0.6, {}), truth_px, 0.05 * truth_px);
  }
}

// A Gaussian step rises from 10 to 90 % over 2.5631 standard deviations.
TEST(StepResponse, SpreadOfAnEdgeIsTheGaussians) {
  for (const double sigma : {0.8, 1.5}) {
    const double found = edge_spread_px({{sigma, 0}, {0, 0}, {1, 0}}, 0.5, 0.505, {});
    EXPECT_NEAR(found, 2.5631 * std::sqrt(sigma * sigma + 1.0 / 6), 0.03);
  }
}

}  // namespace
}  // namespace airtruth::optics
