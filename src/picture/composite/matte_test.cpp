// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/matte.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "foundation/image/colour.h"

namespace airtruth::composite {
namespace {

using image::Chroma;
using image::Colour;
using image::Layer;
using image::Matrix;
using image::Picture;
using image::Range;
using image::Siting;

std::vector<Colour> every_colour() {
  std::vector<Colour> colours = {{Chroma::k444, Matrix::kRgb, Range::kFull, Siting::kLeft}};
  for (Chroma chroma : {Chroma::kNone, Chroma::k420, Chroma::k422, Chroma::k440, Chroma::k444}) {
    for (Matrix matrix : {Matrix::kBt601, Matrix::kBt709}) {
      for (Range range : {Range::kLimited, Range::kFull}) {
        for (Siting siting : {Siting::kLeft, Siting::kCenter, Siting::kTopLeft})
          colours.push_back({chroma, matrix, range, siting});
      }
    }
  }
  return colours;
}

Picture random_picture(int width, int height, const Colour& colour, std::mt19937& random) {
  Picture picture = image::make_picture(width, height, colour);
  for (int p = 0; p < picture.plane_count; ++p) {
    image::Plane& plane = picture.planes[static_cast<std::size_t>(p)];
    for (int y = 0; y < plane.height; ++y) {
      for (int x = 0; x < plane.width; ++x)
        plane.row(y)[x] = static_cast<std::uint8_t>(random() % 256);
    }
  }
  return picture;
}

Layer plain_layer(const PixelBox& patch, const image::LayerPixel& pixel) {
  Layer layer;
  layer.patch = patch;
  const auto size = static_cast<std::size_t>(patch.width * patch.height);
  layer.pixels.assign(size, pixel);
  layer.depth_m.assign(size, 100);
  layer.coverage.assign(1, image::Coverage(layer.patch, pixel.alpha));
  return layer;
}

float linear(int code) { return image::linear_from_srgb(static_cast<float>(code) / 255.0f); }

bool chroma_plane_sample_is(const Picture& picture, int p, int x, int y, float expected) {
  return std::abs(static_cast<float>(picture.planes[static_cast<std::size_t>(p)].row(y)[x]) -
                  expected) <= 0.51f;
}

TEST(Matte, OpaqueLayerLeavesItsExactColourWhateverWasThere) {
  std::mt19937 random(1);
  const image::LayerPixel orange{linear(230), linear(140), linear(40), 1};
  for (const Colour& colour : every_colour()) {
    Picture picture = random_picture(15, 11, colour, random);
    composite_matte(picture, plain_layer({0, 0, 15, 11}, orange), {});
    const image::Ycc expected =
        image::ColourCode(colour).ycc_from_rgb({230 / 255.0f, 140 / 255.0f, 40 / 255.0f});
    for (int p = 0; p < picture.plane_count; ++p) {
      const float want = p == 0 ? expected.y : p == 1 ? expected.cb : expected.cr;
      const image::Plane& plane = picture.planes[static_cast<std::size_t>(p)];
      for (int y = 0; y < plane.height; ++y) {
        for (int x = 0; x < plane.width; ++x)
          ASSERT_TRUE(chroma_plane_sample_is(picture, p, x, y, want));
      }
    }
  }
}

TEST(Matte, AlphaOfZeroChangesNothingOfAnyPicture) {
  std::mt19937 random(2);
  for (const Colour& colour : every_colour()) {
    Picture picture = random_picture(9, 7, colour, random);
    const Picture before = picture.clone();
    const auto visible = composite_matte(picture, plain_layer({1, 2, 5, 4}, {0, 0, 0, 0}), {});
    EXPECT_TRUE(image::identical(picture, before));
    EXPECT_FALSE(visible.at(0).box.has_value());
    EXPECT_EQ(visible.at(0).pixels, 0);
  }
}

// Half of white (1) and half of black (0) is 0.5 in linear light, which sRGB codes as 188 of 255.
TEST(Matte, HalfWhiteOverBlackIsHalfInLinearLight) {
  Picture picture = image::picture_from_rgb8(image::make_rgb8(8, 8),
                                             {Chroma::k420, Matrix::kBt601, Range::kFull});
  composite_matte(picture, plain_layer({2, 2, 4, 4}, {0.5f, 0.5f, 0.5f, 0.5f}), {});
  EXPECT_EQ(picture.planes[0].row(3)[3], 188);
  EXPECT_EQ(picture.planes[1].row(1)[1], 128);
  EXPECT_EQ(picture.planes[0].row(1)[1], 0);
}

// The same with a camera's own curve: 1.055 / sqrt(2) - 0.055 of 255 for an exponent of 2.
TEST(Matte, HalfWhiteOverBlackThroughTheCamerasOwnCurve) {
  Picture picture = image::picture_from_rgb8(image::make_rgb8(8, 8),
                                             {Chroma::k420, Matrix::kBt601, Range::kFull});
  MatteOptions options;
  options.sensor.tone.gamma = 2;
  composite_matte(picture, plain_layer({2, 2, 4, 4}, {0.5f, 0.5f, 0.5f, 0.5f}), options);
  EXPECT_EQ(picture.planes[0].row(3)[3], 176);
}

// A very small coverage changes no code value, however dark the layer and whatever the curve.
TEST(Matte, ATraceOfALayerLeavesEveryGreyAsItWas) {
  for (const double gamma : {0.0, 1.2, 3.0}) {
    Picture picture = image::make_picture(256, 8, {Chroma::k420, Matrix::kBt601, Range::kFull});
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 256; ++x) picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(x);
    for (std::size_t p : {1u, 2u})
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 128; ++x) picture.planes[p].row(y)[x] = 128;
    MatteOptions options;
    options.sensor.tone.gamma = gamma;
    composite_matte(picture, plain_layer({0, 0, 256, 8}, {0, 0, 0, 1e-5f}), options);
    for (int x = 0; x < 256; ++x) EXPECT_EQ(picture.planes[0].row(4)[x], x) << gamma;
  }
}

// A black veil of alpha 1/4 leaves 3/4 of the light of code 200 in each channel.
TEST(Matte, VeilScalesTheLightOfEachChannel) {
  for (const Colour& colour : every_colour()) {
    if (colour.chroma == Chroma::kNone) continue;
    image::Rgb8 rgb = image::make_rgb8(8, 8);
    for (int i = 0; i < 64; ++i) {
      rgb.samples[static_cast<std::size_t>(3 * i)] = 200;
      rgb.samples[static_cast<std::size_t>(3 * i + 1)] = 120;
      rgb.samples[static_cast<std::size_t>(3 * i + 2)] = 60;
    }
    Picture picture = image::picture_from_rgb8(rgb, colour);
    composite_matte(picture, plain_layer({0, 0, 8, 8}, {0, 0, 0, 0.25f}), {});
    const image::Rgb8 after = image::rgb8_from_picture(picture);
    const int codes[3] = {200, 120, 60};
    for (int c = 0; c < 3; ++c) {
      const float expected = 255 * image::srgb_from_linear(0.75f * linear(codes[c]));
      EXPECT_NEAR(
          static_cast<float>(after.at(4, 4)[c]), expected, 2.6f);  // three roundings of Y'CbCr
    }
  }
}

TEST(Matte, WhiterThanWhiteUnderAThinVeilIsKept) {
  Picture picture = image::make_picture(4, 4, {Chroma::kNone, Matrix::kBt601, Range::kLimited});
  for (int y = 0; y < 4; ++y) std::fill_n(picture.planes[0].row(y), 4, std::uint8_t{250});
  composite_matte(picture, plain_layer({0, 0, 4, 4}, {0.001f, 0.001f, 0.001f, 0.001f}), {});
  EXPECT_EQ(picture.planes[0].row(0)[0], 250);
}

TEST(Matte, HighlightBrighterThanTheScaleSaturates) {
  Picture picture = image::make_picture(4, 4, {Chroma::k444, Matrix::kBt709, Range::kLimited});
  for (auto& plane : picture.planes) {
    for (int y = 0; y < 4; ++y) std::fill_n(plane.row(y), 4, std::uint8_t{128});
  }
  composite_matte(picture, plain_layer({0, 0, 4, 4}, {9, 9, 9, 1}), {});
  EXPECT_EQ(picture.planes[0].row(2)[2], 235);
  EXPECT_EQ(picture.planes[1].row(2)[2], 128);
}

// One opaque red pixel on grey. Its chroma sample changes by a quarter where the sample's left
// siting is on the pixel (two rows: 2/4 * 1/2) and by an eighth on the block's right pixel; the
// neighbouring block does not change.
TEST(Matte, ChromaMovesByTheWeightOfItsSiting) {
  const auto moved = [](Siting siting, int x) {
    const Colour colour{Chroma::k420, Matrix::kBt601, Range::kFull, siting};
    Picture picture = image::make_picture(8, 8, colour);
    for (auto& plane : picture.planes) {
      for (int y = 0; y < plane.height; ++y)
        std::fill_n(plane.row(y), plane.width, std::uint8_t{128});
    }
    composite_matte(picture, plain_layer({x, 2, 1, 1}, {1, 0, 0, 1}), {});
    EXPECT_EQ(picture.planes[2].row(1)[2], 128) << "block without the layer";
    return picture.planes[2].row(1)[1] - 128;
  };
  const double full = 127.5;  // Cr of pure red
  EXPECT_EQ(moved(Siting::kCenter, 2), std::lround(full / 4));
  EXPECT_EQ(moved(Siting::kCenter, 3), std::lround(full / 4));
  EXPECT_EQ(moved(Siting::kLeft, 2), std::lround(full / 4));
  EXPECT_EQ(moved(Siting::kLeft, 3), std::lround(full / 8));
  EXPECT_EQ(moved(Siting::kTopLeft, 2), std::lround(full / 4));
  EXPECT_EQ(moved(Siting::kTopLeft, 3), std::lround(full / 8));
}

// A red half plane on grey: chroma crosses its edge as the normal distribution does, and luma
// changes at once.
TEST(Matte, SoftChromaCrossesAnEdgeAsAGaussianDoes) {
  constexpr int kSize = 96, kEdge = 48;
  constexpr double kSpreadPx = 3;
  Picture picture = image::make_picture(
      kSize, kSize, {Chroma::k420, Matrix::kBt601, Range::kFull, Siting::kCenter});
  for (auto& plane : picture.planes)
    for (int y = 0; y < plane.height; ++y)
      std::fill_n(plane.row(y), plane.width, std::uint8_t{128});
  Layer layer = plain_layer({0, 0, kSize, kSize}, {0, 0, 0, 0});
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kEdge; ++x) {
      layer.pixels[layer.index(x, y)] = {0.5f, 0.1f, 0.1f, 1};
      layer.coverage[0].alpha[layer.index(x, y)] = 1;
    }
  MatteOptions options;
  options.sensor.chroma_spread_px = kSpreadPx;
  const auto visible = composite_matte(picture, layer, options);
  const double full = picture.planes[2].row(24)[2] - 128;
  ASSERT_GT(full, 40);
  double last_changed = 0;
  for (int cx = 14; cx < 34; ++cx) {
    const double past_px = 2 * cx + 1 - kEdge;
    const double share = 0.5 * std::erfc(past_px / (kSpreadPx * std::sqrt(2.0)));
    // Whole samples add their own width, and a code value is rounded.
    EXPECT_NEAR(picture.planes[2].row(24)[cx] - 128, full * share, 0.015 * full + 1) << cx;
    if (picture.planes[2].row(24)[cx] != 128) last_changed = 2 * cx + 2;
  }
  EXPECT_EQ(picture.planes[0].row(48)[kEdge], 128);
  EXPECT_NE(picture.planes[0].row(48)[kEdge - 1], 128);
  EXPECT_EQ(visible.at(0).box->right(), last_changed);
  EXPECT_LE(last_changed, kEdge + options.sensor.chroma_px());
}

TEST(Matte, SoftChromaKeepsOffTheOwnAircraft) {
  Picture picture = image::make_picture(64, 64, {Chroma::k420, Matrix::kBt601, Range::kFull});
  for (auto& plane : picture.planes)
    for (int y = 0; y < plane.height; ++y)
      std::fill_n(plane.row(y), plane.width, std::uint8_t{128});
  image::Mask mask{64, 64, std::vector<unsigned char>(64 * 64, 255)};
  for (int y = 0; y < 64; ++y)
    for (int x = 33; x < 64; ++x) mask.free[static_cast<std::size_t>(64 * y + x)] = 0;
  Layer layer = plain_layer({0, 0, 64, 64}, {0, 0, 0, 0});
  for (int y = 20; y < 40; ++y)
    for (int x = 10; x < 30; ++x) {
      layer.pixels[layer.index(x, y)] = {0.5f, 0.1f, 0.1f, 1};
      layer.coverage[0].alpha[layer.index(x, y)] = 1;
    }
  hide(layer, {{own_aircraft(mask)}, {500}});
  MatteOptions options;
  options.sensor.chroma_spread_px = 3;
  composite_matte(picture, layer, options);
  EXPECT_NE(picture.planes[2].row(15)[15], 128);
  for (int y = 0; y < 32; ++y)
    for (int x = 16; x < 32; ++x) ASSERT_EQ(picture.planes[2].row(y)[x], 128) << x << ' ' << y;
}

TEST(Matte, OwnAircraftHidesTheLayerAndTheSumsSaySo) {
  Picture picture = image::make_picture(8, 8, {Chroma::k444, Matrix::kBt601, Range::kFull});
  for (auto& plane : picture.planes) {
    for (int y = 0; y < 8; ++y) std::fill_n(plane.row(y), 8, std::uint8_t{100});
  }
  const Picture before = picture.clone();
  image::Mask mask{8, 8, std::vector<unsigned char>(64, 255)};
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 4; ++x) mask.free[static_cast<std::size_t>(8 * y + x)] = 0;
  }
  Layer layer = plain_layer({2, 2, 4, 4}, {0.5f, 0, 0, 0.5f});
  hide(layer, {{own_aircraft(mask)}, {500}});
  const auto visible = composite_matte(picture, layer, {});
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 4; ++x) EXPECT_EQ(picture.planes[0].row(y)[x], before.planes[0].row(y)[x]);
  }
  EXPECT_EQ(visible.at(0).box, (PixelBox{4, 2, 2, 4}));
  EXPECT_EQ(visible.at(0).pixels, 8);
  EXPECT_DOUBLE_EQ(visible.at(0).alpha_sum_px, 4);
}

TEST(Matte, PatchThatLeavesTheFrameIsACallersMistake) {
  Picture picture = image::make_picture(8, 8, {Chroma::k444});
  EXPECT_THROW(composite_matte(picture, plain_layer({5, 0, 4, 4}, {0, 0, 0, 1}), {}),
               std::logic_error);
  EXPECT_THROW(composite_matte(picture, plain_layer({-1, 0, 4, 4}, {0, 0, 0, 1}), {}),
               std::logic_error);
  Layer small = plain_layer({0, 0, 4, 4}, {0, 0, 0, 1});
  small.closed.assign(4, 0);
  EXPECT_THROW(composite_matte(picture, small, {}), std::logic_error);
}

TEST(Matte, EmptyLayerAnswersForEveryIntruder) {
  Picture picture = image::make_picture(8, 8, {Chroma::k444});
  Layer layer;
  layer.coverage.resize(3);
  EXPECT_EQ(composite_matte(picture, layer, {}).size(), 3u);
}

// Random blobs of two intruders, the second in a part of the patch: some pixels belong to both,
// many to none.
Layer random_layer(int width, int height, std::mt19937& random) {
  const auto within = [&random](int size) {
    return static_cast<int>(random() % static_cast<unsigned>(size));
  };
  const auto unit = [&random] { return static_cast<float>(random() % 1001) / 1000.0f; };
  Layer layer;
  layer.patch.x = within(width);
  layer.patch.y = within(height);
  layer.patch.width = 1 + within(width - layer.patch.x);
  layer.patch.height = 1 + within(height - layer.patch.y);
  const auto size = static_cast<std::size_t>(layer.patch.width * layer.patch.height);
  layer.pixels.resize(size);
  layer.depth_m.assign(size, 50);
  PixelBox part = layer.patch;
  part.x += within(layer.patch.width), part.y += within(layer.patch.height);
  part = *intersection(part, layer.patch);
  layer.coverage = {image::Coverage(layer.patch), image::Coverage(part)};
  each_pixel(layer.coverage[0], [&](int x, int y, float& first) {
    if (random() % 3 != 0) return;
    first = unit() * 0.5f;
    const float second = part.contains(x, y) && random() % 2 == 0 ? unit() * 0.5f : 0.0f;
    const float alpha = first + second;
    if (second > 0) layer.coverage[1].alpha[layer.coverage[1].index(x, y)] = second;
    layer.pixels[layer.index(x, y)] = {unit() * alpha, unit() * alpha, unit() * alpha, alpha};
  });
  return layer;
}

struct Difference {
  const Picture& before;
  const Picture& after;
  bool at(int plane, int x, int y) const {
    const auto p = static_cast<std::size_t>(plane);
    return before.planes[p].row(y)[x] != after.planes[p].row(y)[x];
  }
  bool of_pixel(int x, int y) const {
    if (at(0, x, y)) return true;
    if (after.plane_count == 1) return false;
    const int cx = x >> image::log2_chroma_width(after.colour.chroma);
    const int cy = y >> image::log2_chroma_height(after.colour.chroma);
    return at(1, cx, cy) || at(2, cx, cy);
  }
};

bool touches(const PixelBox& box, const PixelBox& block) {
  return intersection(box, block).has_value();
}

void expect_only_inside(const Difference& difference, const std::vector<Visible>& visible) {
  for (int p = 0; p < difference.after.plane_count; ++p) {
    const image::Plane& plane = difference.after.planes[static_cast<std::size_t>(p)];
    const int sx = p == 0 ? 0 : image::log2_chroma_width(difference.after.colour.chroma);
    const int sy = p == 0 ? 0 : image::log2_chroma_height(difference.after.colour.chroma);
    for (int y = 0; y < plane.height; ++y) {
      for (int x = 0; x < plane.width; ++x) {
        const PixelBox block{x << sx, y << sy, 1 << sx, 1 << sy};
        bool inside = false;
        for (const Visible& v : visible) inside = inside || (v.box && touches(*v.box, block));
        ASSERT_TRUE(inside || !difference.at(p, x, y));
      }
    }
  }
}

void expect_tight(const Difference& difference,
                  const Layer& layer,
                  std::size_t intruder,
                  const Visible& visible) {
  std::optional<PixelBox> box;
  std::int64_t pixels = 0;
  for (int y = layer.patch.y; y < layer.patch.bottom(); ++y) {
    for (int x = layer.patch.x; x < layer.patch.right(); ++x) {
      if (layer.coverage[intruder].at(x, y) <= 0 || !difference.of_pixel(x, y)) continue;
      ++pixels;
      const PixelBox pixel{x, y, 1, 1};
      box = box ? bounds(*box, pixel) : pixel;
    }
  }
  ASSERT_EQ(visible.box, box);
  ASSERT_EQ(visible.pixels, pixels);
}

TEST(MatteProperty, NothingOutsideTheVisibleBoxesChangesAndTheBoxesAreTight) {
  std::mt19937 random(3);
  for (const Colour& colour : every_colour()) {
    for (int round = 0; round < 8; ++round) {
      const int width = 3 + static_cast<int>(random() % 30);
      const int height = 3 + static_cast<int>(random() % 20);
      Picture picture = random_picture(width, height, colour, random);
      const Picture before = picture.clone();
      const Layer layer = random_layer(width, height, random);
      const auto visible = composite_matte(picture, layer, {});
      const Difference difference{before, picture};
      expect_only_inside(difference, visible);
      for (std::size_t i = 0; i < 2; ++i) expect_tight(difference, layer, i, visible.at(i));
      MatteOptions soft;
      soft.sensor.chroma_spread_px = 1.5;
      picture = before.clone();
      const auto seen = composite_matte(picture, layer, soft);
      expect_only_inside({before, picture}, seen);
    }
  }
}

}  // namespace
}  // namespace airtruth::composite
