// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/cover.h"

#include <cmath>

#include <gtest/gtest.h>

#include "picture/composite/matte.h"
#include "picture/composite/spread.h"

namespace airtruth::composite {
namespace {

constexpr int kCoverWidth = 90;
constexpr int kCoverHeight = 70;

// An opaque grey rectangle; a pixel's alpha is the share that the rectangle covers.
image::Layer rectangle(const Box& box) {
  image::Layer layer;
  layer.patch = pixels_of(box);
  const auto size =
      static_cast<std::size_t>(layer.patch.width) * static_cast<std::size_t>(layer.patch.height);
  layer.pixels.resize(size);
  layer.depth_m.assign(size, 500);
  layer.coverage.assign(1, image::Coverage(layer.patch));
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y)
    for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
      const double across = std::min(box.right(), x + 1.0) - std::max(box.x, double(x));
      const double down = std::min(box.bottom(), y + 1.0) - std::max(box.y, double(y));
      const auto share = static_cast<float>(across * down);
      layer.pixels[layer.index(x, y)] = {0.2F * share, 0.2F * share, 0.2F * share, share};
      layer.coverage[0].alpha[layer.index(x, y)] = share;
    }
  layer.areas = {{box.area(), box.area(), box.area(), box.area(), box.area()}};
  return layer;
}

// The share of [x, x + 1) under [from, to) after a Gaussian blur: the Gaussian's second integral at
// four places.
double seen_share(double x, double from, double to, double sigma) {
  const auto ramp = [sigma](double u) {
    if (sigma == 0) return std::max(0.0, u);
    const double z = u / (sigma * std::sqrt(2.0));
    return 0.5 * u * (1 + std::erf(z)) + sigma / std::sqrt(2 * kPi) * std::exp(-z * z);
  };
  return ramp(x + 1 - from) - ramp(x - from) - ramp(x + 1 - to) + ramp(x - to);
}

// Bounds of the pixels of at least this alpha, in closed form.
std::optional<PixelBox> bounds_in_closed_form(const Box& box, double sigma, double alpha) {
  std::optional<PixelBox> found;
  for (int y = 0; y < kCoverHeight; ++y)
    for (int x = 0; x < kCoverWidth; ++x) {
      const double here =
          seen_share(x, box.x, box.right(), sigma) * seen_share(y, box.y, box.bottom(), sigma);
      if (here < alpha) continue;
      found = found ? bounds(*found, {x, y, 1, 1}) : PixelBox{x, y, 1, 1};
    }
  return found;
}

// Coverage is computed by pixel, and the kernel is the Gaussian's integral over each pixel, which
// adds a variance of 1/12 px^2. The remaining difference of alpha is below 0.03, so the box lies
// between those of the two thresholds.
TEST(Cover, TheBoxIsTheClosedFormsOfARectangleThroughAGaussian) {
  constexpr double kAlpha = (kCoveredAlpha - 0.5) / 255;
  constexpr double kOff = 0.03;
  int compared = 0;
  for (const double sigma : {0.0, 0.5, 0.8, 1.5, 3.0})
    for (const double width : {0.6, 1.0, 3.3, 20.0})
      for (const double shift : {0.0, 0.25, 0.5, 0.9}) {
        const Box box{30 + shift, 25 + 0.7 * shift, width, 0.4 * width + 0.5};
        const image::Layer layer =
            spread(rectangle(box), {sigma, sigma}, 0, kCoverWidth, kCoverHeight);
        const auto found = covered(layer, 0);
        const double effective = sigma > 0 ? std::sqrt(sigma * sigma + 1.0 / 12) : 0;
        const auto most = bounds_in_closed_form(box, effective, kAlpha - kOff);
        const auto least = bounds_in_closed_form(box, effective, kAlpha + kOff);
        SCOPED_TRACE(testing::Message() << sigma << ' ' << width << ' ' << shift);
        if (!most) {
          EXPECT_FALSE(found);
          continue;
        }
        if (least) {
          ASSERT_TRUE(found);
          EXPECT_EQ(bounds(found->box, *least), found->box);
          ++compared;
        }
        if (found) {
          EXPECT_EQ(bounds(*most, found->box), *most);
        }
      }
  EXPECT_GT(compared, 50);
}

TEST(Cover, TheMaskHoldsTheSumAndTheBoxOfTheCoverage) {
  const image::Layer layer =
      spread(rectangle({20.3, 30.2, 17, 5}), {0.9, 0.9}, 0, kCoverWidth, kCoverHeight);
  const AlphaMask mask = alpha_mask(layer, 0);
  double sum = 0;
  int pixels = 0;
  for (const std::uint8_t a : mask.alpha) sum += a / 255.0, pixels += a > 0 ? 1 : 0;
  EXPECT_NEAR(sum, 17 * 5, pixels * 0.5 / 255);
  const auto found = covered(mask);
  EXPECT_EQ(found, covered(layer, 0));
  EXPECT_EQ(found->area_px, std::count_if(mask.alpha.begin(), mask.alpha.end(), [](std::uint8_t a) {
              return a >= kCoveredAlpha;
            }));
  EXPECT_TRUE(alpha_mask(layer, 1).empty());
  EXPECT_FALSE(covered(AlphaMask{}));
}

TEST(Cover, WhatTheOwnAircraftHidesIsNotCovered) {
  image::Mask own{
      kCoverWidth, kCoverHeight, std::vector<unsigned char>(kCoverWidth * kCoverHeight, 255)};
  for (int y = 0; y < kCoverHeight; ++y)
    for (int x = 0; x < 30; ++x) own.free[static_cast<std::size_t>(y * kCoverWidth + x)] = 0;
  const Occlusion occlusion{{own_aircraft(own)}, {500}};
  image::Layer sharp = rectangle({25, 30, 20, 10});
  find_areas(sharp, occlusion);
  EXPECT_NEAR(sharp.areas[0].free_px, 15 * 10, 1e-3);
  EXPECT_NEAR(sharp.areas[0].seen_px, 20 * 10, 1e-9);
  image::Layer layer = spread(sharp, {1, 1}, 0, kCoverWidth, kCoverHeight);
  EXPECT_NEAR(layer.areas[0].free_px, 15 * 10, 1e-3);
  EXPECT_TRUE(covered(layer, 0)->box.x < 25);
  hide(layer, occlusion);
  const auto found = covered(layer, 0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->box.x, 30);
  // The first pixel beyond the edge at 45 has 0.31, the next 0.07.
  EXPECT_EQ(found->box.right(), 46);
}

// Alpha behind a soft edge is (1 - mask) of what it was, for the farther one of two alone.
TEST(Cover, AnOccluderHidesWhatIsFartherInItsShare) {
  const auto cover = [](int x, int) { return static_cast<float>(std::clamp(x - 28, 0, 10)) / 10; };
  Occlusion occlusion{{{800, cover}}, {900, 700}};
  image::Layer both = rectangle({20, 30, 30, 10});
  both.coverage.push_back(image::Coverage(both.patch));
  const auto set = [&](int x, int y, float far, float near) {
    const std::size_t i = both.index(x, y);
    both.coverage[0].alpha[i] = far, both.coverage[1].alpha[i] = near;
    both.pixels[i] = {0.3F * (far + near), 0.2F * (far + near), 0.1F * (far + near), far + near};
  };
  for (int x = 20; x < 50; ++x)
    for (int y = 30; y < 40; ++y) set(x, y, y < 35 ? 0.8F : 0.5F, y < 35 ? 0.0F : 0.25F);
  both.areas = {{195, 195, 195, 195, 195}, {37.5, 37.5, 37.5, 37.5, 37.5}};
  const image::Layer before = both;
  find_areas(both, occlusion);
  hide(both, occlusion);
  double clear_px = 0;
  for (int x = 20; x < 50; ++x)
    for (int y = 30; y < 40; ++y) {
      const std::size_t i = both.index(x, y);
      const double shows = 1 - std::clamp((x - 28) / 10.0, 0.0, 1.0);
      const double far = shows * before.coverage[0].alpha[i], near = before.coverage[1].alpha[i];
      clear_px += far;
      EXPECT_NEAR(both.coverage[0].alpha[i], far, 1e-6) << x;
      EXPECT_EQ(both.coverage[1].alpha[i], before.coverage[1].alpha[i]);
      EXPECT_NEAR(both.pixels[i].alpha, far + near, 1e-6) << x;
      EXPECT_NEAR(both.pixels[i].red, 0.3 * (far + near), 1e-6) << x;
      if (x <= 28) {
        EXPECT_EQ(both.pixels[i].alpha, before.pixels[i].alpha);
      }
    }
  EXPECT_NEAR(both.areas[0].clear_px, clear_px, 1e-3);
  EXPECT_EQ(both.areas[1].clear_px, 37.5);
  for (const std::size_t i : {0U, 1U}) EXPECT_EQ(both.areas[i].free_px, before.areas[i].free_px);
}

// The documented alpha: 20 of 255.
TEST(Cover, IsCoveredFromTheStatedAlphaOn) {
  EXPECT_EQ(kCoveredAlpha, 20);
  EXPECT_EQ(alpha_code(0.08F), 20);
  EXPECT_EQ(alpha_code(0.076F), 19);
  EXPECT_EQ(alpha_code(1.5F), 255);
  EXPECT_EQ(alpha_code(-1), 0);
  EXPECT_FALSE(covered(rectangle({10, 10, 0.3, 0.25}), 0));
  EXPECT_EQ(covered(rectangle({10, 10, 0.3, 0.3}), 0), (Covered{{10, 10, 1, 1}, 1}));
}

// A codec that leaves ripple in every sample of its input.
class Rippling : public PatchCoder {
 public:
  Coded code(const PixelBox&,
             const image::Picture& with_layer,
             const image::Picture& background) override {
    image::Picture coded = with_layer.clone();
    for (int y = 0; y < coded.height; ++y)
      for (int x = 0; x < coded.width; ++x) {
        std::uint8_t& sample = coded.planes[0].row(y)[x];
        sample = static_cast<std::uint8_t>(sample + ((x + y) % 2 == 0 ? 2 : 1));
      }
    return {std::move(coded), background.clone()};
  }
};

// A codec's ripple changes samples all around but no covered box.
TEST(Cover, ACodecsRippleMovesTheVisibleBoxAlone) {
  const image::Layer layer =
      spread(rectangle({40.2, 30.4, 9, 3}), {0.8, 0.8}, 8, kCoverWidth, kCoverHeight);
  const auto composed = [&](PatchCoder* coder) {
    image::Picture picture =
        image::make_picture(kCoverWidth,
                            kCoverHeight,
                            {image::Chroma::kNone, image::Matrix::kBt601, image::Range::kFull});
    for (int y = 0; y < kCoverHeight; ++y)
      for (int x = 0; x < kCoverWidth; ++x) picture.planes[0].row(y)[x] = 180;
    MatteOptions options;
    options.coder = coder;
    return composite_matte(picture, layer, options).at(0);
  };
  Rippling codec;
  const Visible plain = composed(nullptr);
  const Visible coded = composed(&codec);
  EXPECT_EQ(plain.covered, coded.covered);
  EXPECT_EQ(plain.covered, covered(layer, 0));
  EXPECT_NE(plain.box, coded.box);
}

}  // namespace
}  // namespace airtruth::composite
