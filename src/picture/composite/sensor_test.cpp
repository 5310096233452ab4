// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/sensor.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "foundation/image/colour.h"
#include "picture/composite/matte.h"
#include "picture/composite/spread.h"

namespace airtruth::composite {
namespace {

image::Layer square(int side, float alpha, float light, int at = 20) {
  image::Layer layer;
  layer.patch = {at, at, side, side};
  const auto size = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  layer.pixels.assign(size, {light * alpha, light * alpha, light * alpha, alpha});
  layer.depth_m.assign(size, 2000.0F);
  layer.coverage = {image::Coverage(layer.patch, alpha)};
  layer.areas = {{double(size), double(size)}};
  return layer;
}

image::Picture grey_picture(int side, std::uint8_t luma) {
  image::Picture picture = image::make_picture(side, side, {image::Chroma::kNone});
  for (int y = 0; y < side; ++y) std::fill_n(picture.planes[0].row(y), side, luma);
  return picture;
}

TEST(Haze, FollowsKoschmieder) {
  image::Layer layer = square(2, 0.5F, 0.8F);
  add_haze(layer, {0.1, 0.2, 0.0}, {0.5, 0.6, 0.7});
  const double t = std::exp(-0.1 * 2);
  EXPECT_NEAR(layer.pixels[0].red, 0.5 * (0.8 * t + 0.5 * (1 - t)), 1e-6);
  const double u = std::exp(-0.2 * 2);
  EXPECT_NEAR(layer.pixels[0].green, 0.5 * (0.8 * u + 0.6 * (1 - u)), 1e-6);
  EXPECT_NEAR(layer.pixels[0].blue, 0.5 * 0.8, 1e-6);
  EXPECT_FLOAT_EQ(layer.pixels[0].alpha, 0.5F);
}

TEST(Spread, KeepsLightAndCoverageAndCentre) {
  const image::Layer layer = square(5, 1, 0.4F);
  const image::Layer soft = spread(layer, {0.8, 0.8}, 0, 60, 60);
  double light = 0, coverage = 0, alpha = 0, x_sum = 0;
  for (int y = soft.patch.y; y < soft.patch.bottom(); ++y)
    for (int x = soft.patch.x; x < soft.patch.right(); ++x) {
      const std::size_t i = soft.index(x, y);
      light += double(soft.pixels[i].red);
      alpha += double(soft.pixels[i].alpha);
      coverage += double(soft.coverage[0].at(x, y));
      x_sum += double(soft.coverage[0].at(x, y)) * (x + 0.5);
    }
  EXPECT_NEAR(alpha, 25, 0.02);
  EXPECT_NEAR(light, 10, 0.01);
  EXPECT_NEAR(coverage, 25, 0.02);
  EXPECT_NEAR(x_sum / coverage, 22.5, 1e-4);
}

// Whole pixels from 10 on, blurred with weights that are a Gaussian's integrals over pixels, give
// the Gaussian's distribution function at the pixels' centres.
TEST(Spread, AStepBecomesTheErrorFunction) {
  const double sigma = 1.1;
  const image::Layer soft = spread(square(40, 1, 1, 10), {sigma, sigma}, 0, 60, 60);
  for (int x = 8; x < 13; ++x)
    EXPECT_NEAR(soft.pixels[soft.index(x, 30)].alpha,
                0.5 * (1 + std::erf((x + 0.5 - 10) / (sigma * std::sqrt(2.0)))),
                0.003)
        << x;
}

TEST(Spread, HasADeviationAlongEachAxis) {
  const image::Layer soft = spread(square(1, 1, 1, 30), {0.6, 1.1}, 0, 60, 60);
  double across_px2 = 0, down_px2 = 0;
  for (int y = soft.patch.y; y < soft.patch.bottom(); ++y)
    for (int x = soft.patch.x; x < soft.patch.right(); ++x) {
      const double alpha = double(soft.pixels[soft.index(x, y)].alpha);
      across_px2 += alpha * (x - 30) * (x - 30);
      down_px2 += alpha * (y - 30) * (y - 30);
    }
  // Of the Gaussian and of the pixel that it is integrated over, less what lies beyond its reach.
  EXPECT_NEAR(across_px2, 0.6 * 0.6 + 1.0 / 12, 0.02);
  EXPECT_NEAR(down_px2, 1.1 * 1.1 + 1.0 / 12, 0.04);
}

TEST(Spread, IsCutByTheFrameAlone) {
  const image::Layer soft = spread(square(4, 1, 1, 0), {1.0, 1.0}, 2, 60, 60);
  EXPECT_EQ(soft.patch, (PixelBox{0, 0, 9, 9}));
}

// A square of 40 pixels from (20, 20) on, whole, and in a frame that begins at (40, 40).
TEST(Spread, WhatTheFrameCutsContinuesBeyondIt) {
  const image::Layer whole = spread(square(40, 0.8F, 0.5F, 20), {1.7, 1.7}, 3, 100, 100);
  const image::Layer cut = spread(square(20, 0.8F, 0.5F, 0), {1.7, 1.7}, 3, 60, 60);
  for (int y = 0; y < cut.patch.bottom(); ++y)
    for (int x = 0; x < cut.patch.right(); ++x) {
      const std::size_t i = cut.index(x, y), j = whole.index(x + 40, y + 40);
      ASSERT_NEAR(cut.pixels[i].alpha, whole.pixels[j].alpha, 1e-5) << x << ' ' << y;
      ASSERT_NEAR(cut.pixels[i].red, whole.pixels[j].red, 1e-5);
      ASSERT_NEAR(cut.coverage[0].at(x, y), whole.coverage[0].at(x + 40, y + 40), 1e-5);
    }
}

TEST(Sharpen, LeavesEvenChangesAloneAndOvershootsAtSteps) {
  Sensor sensor;
  sensor.sharpening = 0.8;
  sensor.sharpening_px = 1.0;
  std::vector<float> change(40 * 40, 0.0F);
  for (int y = 0; y < 40; ++y)
    for (int x = 20; x < 40; ++x) change[static_cast<std::size_t>(y * 40 + x)] = 50;
  sharpen(change, {0, 0, 40, 40}, {-9, -9, 99, 99}, sensor);
  EXPECT_NEAR(change[20 * 40 + 28], 50, 1e-3);
  EXPECT_GT(change[20 * 40 + 20], 55);
  EXPECT_LT(change[20 * 40 + 19], -5);
  EXPECT_GT(change[20 * 40 + 39], 55);
}

TEST(Sharpen, LeavesWhatTheFrameCutsAlone) {
  Sensor sensor;
  sensor.sharpening = 0.8;
  sensor.sharpening_px = 1.0;
  const PixelBox frame{0, 0, 20, 20};
  std::vector<float> change(20 * 20, 50.0F);
  sharpen(change, frame, frame, sensor);
  for (const float value : change) ASSERT_NEAR(value, 50, 1e-3);
}

TEST(Noise, HasItsCurveItsCorrelationAndAnotherFaceEachFrame) {
  const PixelBox patch{3, 5, 300, 300};
  for (const double correlation_px : {0.0, 0.6}) {
    const auto field = noise_field(patch, 9, 4, correlation_px);
    double sum = 0, squares = 0, beside = 0;
    for (std::size_t i = 0; i + 1 < field.size(); ++i) {
      sum += double(field[i]), squares += double(field[i]) * double(field[i]);
      beside += double(field[i]) * double(field[i + 1]);
    }
    const double n = double(field.size());
    EXPECT_NEAR(sum / n, 0, 0.02);
    EXPECT_NEAR(squares / n, 1, 0.03);
    // The pixel weights of a Gaussian of 0.6 px: 0.595, 0.196 to each side, 0.006 (from its
    // integral).
    const double expected = correlation_px > 0 ? 2 * (0.595 * 0.196 + 0.196 * 0.006) /
                                                     (0.595 * 0.595 + 2 * 0.196 * 0.196)
                                               : 0;
    EXPECT_NEAR(beside / squares, expected, 0.02);
  }
  EXPECT_NE(noise_field(patch, 9, 4, 0), noise_field(patch, 9, 5, 0));
  // A pixel has the same noise in every patch.
  const auto part = noise_field({100, 50, 20, 10}, 9, 4, 0.6);
  const auto whole = noise_field(patch, 9, 4, 0.6);
  EXPECT_FLOAT_EQ(part[0], whole[(50 - 5) * 300 + (100 - 3)]);
  // Linear light 0.2140 is coded as 0.5; the curve's slope there is 1.107 (IEC 61966-2-1).
  Sensor sensor;
  sensor.noise_gain = 4e-4;
  sensor.noise_floor = 2e-5;
  const double slope = 1 / 2.4 * 1.055 * std::pow(0.2140, 1 / 2.4 - 1);
  EXPECT_NEAR(noise_sigma(0.5F, 219, sensor), 219 * slope * std::sqrt(4e-4 * 0.2140 + 2e-5), 0.02);
}

TEST(Matte, WithASensorTouchesNothingBeyondItsReach) {
  const image::Layer layer = spread(square(6, 1, 0.9F), {0.7, 0.7}, 3, 60, 60);
  image::Picture picture = grey_picture(60, 90);
  MatteOptions options;
  options.sensor.sharpening = 1;
  options.sensor.noise_gain = 1e-3;
  const auto visible = composite_matte(picture, layer, options);
  ASSERT_TRUE(visible[0].box);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x)
      ASSERT_TRUE(visible[0].box->contains(x, y) || picture.planes[0].row(y)[x] == 90);
  ASSERT_TRUE(visible[0].centroid);
  EXPECT_NEAR(visible[0].centroid->x(), 23, 1e-3);
  // The halo of sharpening belongs to the visible box.
  EXPECT_LT(visible[0].box->x, 19);
}

image::Picture even_picture(int side, const image::Colour& colour) {
  image::Rgb8 rgb = image::make_rgb8(side, side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      rgb.at(x, y)[0] = 90;
      rgb.at(x, y)[1] = 120;
      rgb.at(x, y)[2] = 150;
    }
  return image::picture_from_rgb8(rgb, colour);
}

// BT.601's matrix, so that both have the same luma.
TEST(Matte, ASensorDoesTheSameToPlanesOfRedGreenAndBlueAsToLumaAndChroma) {
  image::Layer layer = square(12, 0.8F, 0.3F);
  for (image::LayerPixel& pixel : layer.pixels) pixel.red = 0.4F, pixel.blue = 0.1F;
  layer = spread(layer, {0.7, 0.7}, 9, 60, 60);
  Sensor noisy, sharp, soft, all;
  noisy.noise_floor = 2e-4;
  sharp.sharpening = 1;
  sharp.sharpening_px = 1.5;
  soft.chroma_spread_px = 2;
  all = sharp;
  all.noise_floor = noisy.noise_floor;
  all.chroma_spread_px = soft.chroma_spread_px;
  for (const Sensor& sensor : {noisy, sharp, soft, all}) {
    MatteOptions options;
    options.sensor = sensor;
    const auto seen = [&](image::Matrix matrix) {
      image::Picture picture = even_picture(60, {image::Chroma::k444, matrix, image::Range::kFull});
      composite_matte(picture, layer, options);
      return image::rgb8_from_picture(picture);
    };
    const image::Rgb8 of_rgb = seen(image::Matrix::kRgb), of_ycc = seen(image::Matrix::kBt601);
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x)
        for (int c = 0; c < 3; ++c)
          // The rounding of Y, Cb and Cr, before and after.
          ASSERT_NEAR(of_rgb.at(x, y)[c], of_ycc.at(x, y)[c], 4) << x << ' ' << y << ' ' << c;
  }
}

// What does not reach a pixel leaves its bits, and a grey intruder stays grey.
TEST(Matte, OnRedGreenAndBlueASensorKeepsGreyGreyAndTheRestUntouched) {
  const image::Layer layer = spread(square(6, 1, 0.02F), {0.7, 0.7}, 9, 60, 60);
  image::Picture picture =
      image::make_picture(60, 60, {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  for (image::Plane& plane : picture.planes)
    for (int y = 0; y < 60; ++y) std::fill_n(plane.row(y), 60, std::uint8_t{120});
  MatteOptions options;
  options.sensor.sharpening = 1;
  options.sensor.noise_floor = 1e-5;
  options.sensor.chroma_spread_px = 2;
  const auto visible = composite_matte(picture, layer, options);
  ASSERT_TRUE(visible[0].box);
  int brightest = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      const int green = picture.planes[0].row(y)[x];
      ASSERT_NEAR(picture.planes[1].row(y)[x], green, 1);
      ASSERT_NEAR(picture.planes[2].row(y)[x], green, 1);
      brightest = std::max(brightest, green);
      if (!visible[0].box->contains(x, y)) {
        ASSERT_EQ(green, 120);
      }
    }
  EXPECT_GT(brightest, 124);  // the halo
}

}  // namespace
}  // namespace airtruth::composite
