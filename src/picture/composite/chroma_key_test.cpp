// SPDX-License-Identifier: Apache-2.0
#include "picture/composite/chroma_key.h"

#include <gtest/gtest.h>

#include "foundation/image/colour.h"

namespace airtruth::composite {
namespace {

using image::Picture;
using image::Rgb8;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
const image::Colour kRgbPlanes{
    image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull, image::Siting::kCenter};

void set(Rgb8& rgb, int x, int y, int r, int g, int b) {
  std::uint8_t* p = rgb.at(x, y);
  p[0] = static_cast<std::uint8_t>(r);
  p[1] = static_cast<std::uint8_t>(g);
  p[2] = static_cast<std::uint8_t>(b);
}

// Pure green with a rectangle of one colour.
Rgb8 virtual_image(const PixelBox& box, int r, int g, int b) {
  Rgb8 rgb = image::make_rgb8(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (box.contains(x, y)) {
        set(rgb, x, y, r, g, b);
      } else {
        set(rgb, x, y, 0, 255, 0);
      }
    }
  }
  return rgb;
}

Rgb8 ramp() {
  Rgb8 rgb = image::make_rgb8(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) set(rgb, x, y, 3 * x, 4 * y, 128 + x - y);
  }
  return rgb;
}

Homography shift(double x, double y) {
  Homography h = Homography::Identity();
  h(0, 2) = x;
  h(1, 2) = y;
  return h;
}

TEST(ChromaKey, IdentityPastesTheRectangleAndNothingElse) {
  Picture frame = image::picture_from_rgb8(ramp(), kRgbPlanes);
  const PixelBox box{10, 20, 8, 5};
  const auto replaced =
      composite_chroma_key(frame, virtual_image(box, 200, 30, 90), Homography::Identity(), {});
  Rgb8 expected = ramp();
  for (int y = 20; y < 25; ++y) {
    for (int x = 10; x < 18; ++x) set(expected, x, y, 200, 30, 90);
  }
  EXPECT_TRUE(image::identical(frame, image::picture_from_rgb8(expected, kRgbPlanes)));
  EXPECT_EQ(std::count(replaced.begin(), replaced.end(), 255), 40);
}

TEST(ChromaKey, HomographyCarriesTheIntruderFromReferenceToFrame) {
  Picture frame = image::picture_from_rgb8(ramp(), kRgbPlanes);
  ChromaKeyImages images;
  const PixelBox box{10, 20, 8, 5};
  composite_chroma_key(frame, virtual_image(box, 200, 30, 90), shift(6, -4), {}, &images);
  Rgb8 expected = ramp();
  for (int y = 16; y < 21; ++y) {
    for (int x = 16; x < 24; ++x) set(expected, x, y, 200, 30, 90);
  }
  EXPECT_TRUE(image::identical(frame, image::picture_from_rgb8(expected, kRgbPlanes)));
  // The background comes back by H^-1.
  EXPECT_EQ(images.a.at(20, 20)[0], ramp().at(26, 16)[0]);
  EXPECT_EQ(images.b.at(12, 22)[0], 200);
  EXPECT_EQ(images.c.at(18, 18)[0], 200);
  EXPECT_EQ(images.d.at(18, 18)[1], 30);
  EXPECT_EQ(images.d.at(40, 40)[1], 255);
}

// H doubles the size about the image's corner. Pixels 10..15 become 20..31 because the origin is
// the corner; with the origin at the first pixel's centre they would become 19.5..30.5.
TEST(ChromaKey, HomographyIsInPixelsFromTheCorner) {
  Picture frame = image::picture_from_rgb8(ramp(), kRgbPlanes);
  Homography twice = Homography::Identity();
  twice(0, 0) = twice(1, 1) = 2;
  ChromaKeyImages images;
  composite_chroma_key(frame, virtual_image({10, 8, 6, 6}, 200, 30, 90), twice, {}, &images);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(images.d.at(20 + k, 22)[0], images.d.at(31 - k, 22)[0]);
    EXPECT_EQ(images.d.at(19 - k, 22)[0], images.d.at(32 + k, 22)[0]);
  }
  EXPECT_GT(images.d.at(20, 22)[0], 100);
  EXPECT_LT(images.d.at(19, 22)[0], 100);
}

TEST(ChromaKey, HalfAPixelMixesTheEdgeHalfAndHalf) {
  Picture frame = image::picture_from_rgb8(ramp(), kRgbPlanes);
  ChromaKeyImages images;
  composite_chroma_key(
      frame, virtual_image({20, 20, 12, 12}, 200, 200, 200), shift(0.5, 0), {}, &images);
  EXPECT_NEAR(images.d.at(20, 26)[0], 100, 2);
  EXPECT_NEAR(images.d.at(32, 26)[0], 100, 2);
  // Red: the mean of intruder and ramp.
  EXPECT_NEAR(frame.planes[2].row(26)[20], (200 + 3 * 19.5) / 2, 4);
}

TEST(ChromaKey, SamplesThatAreNotReplacedKeepTheirBitsInEveryLayout) {
  for (image::Chroma chroma :
       {image::Chroma::kNone, image::Chroma::k420, image::Chroma::k422, image::Chroma::k444}) {
    const image::Colour colour{
        chroma, image::Matrix::kBt601, image::Range::kFull, image::Siting::kCenter};
    Picture frame = image::picture_from_rgb8(ramp(), colour);
    const Picture before = frame.clone();
    Homography h = shift(1.3, -0.7);
    h(0, 1) = 0.01;
    h(2, 0) = 1e-5;
    const auto replaced =
        composite_chroma_key(frame, virtual_image({20, 14, 9, 7}, 240, 240, 240), h, {});
    const auto at = [&](int x, int y) {
      return x < kWidth && y < kHeight && replaced[static_cast<std::size_t>(y * kWidth + x)] != 0;
    };
    EXPECT_GT(std::count(replaced.begin(), replaced.end(), 255), 60);
    for (int p = 0; p < frame.plane_count; ++p) {
      const int sx = p == 0 ? 0 : image::log2_chroma_width(chroma);
      const int sy = p == 0 ? 0 : image::log2_chroma_height(chroma);
      const auto plane = static_cast<std::size_t>(p);
      for (int y = 0; y < frame.planes[plane].height; ++y) {
        for (int x = 0; x < frame.planes[plane].width; ++x) {
          bool touched = false;
          for (int k = 0; k < 4; ++k)
            touched = touched || at((x << sx) + (k & sx), (y << sy) + ((k >> 1) & sy));
          ASSERT_TRUE(touched || frame.planes[plane].row(y)[x] == before.planes[plane].row(y)[x]);
        }
      }
    }
  }
}

// Lanczos filtering rings: beyond a white edge D deviates from pure green by a few levels. With the
// default tolerance the replaced region ends within two pixels of the edge; without a tolerance it
// reaches three or more.
TEST(ChromaKey, ToleranceKeepsTheRingingOut) {
  const auto leftmost = [](int tolerance) {
    Picture frame = image::picture_from_rgb8(ramp(), kRgbPlanes);
    ChromaKeyOptions options;
    if (tolerance >= 0) options.green_tolerance = tolerance;
    const auto replaced = composite_chroma_key(
        frame, virtual_image({24, 12, 20, 20}, 255, 255, 255), shift(0.5, 0), options);
    int x = 0;
    while (replaced[static_cast<std::size_t>(22 * kWidth + x)] == 0) ++x;
    return x;
  };
  EXPECT_LE(leftmost(0), 22);
  EXPECT_GE(leftmost(-1), 24);
}

TEST(ChromaKey, OwnAircraftIsNotPaintedOver) {
  Picture frame = image::picture_from_rgb8(ramp(), kRgbPlanes);
  const Picture before = frame.clone();
  const image::Mask mask{kWidth, kHeight, std::vector<unsigned char>(kWidth * kHeight, 0)};
  composite_chroma_key(
      frame, virtual_image({24, 12, 20, 20}, 255, 255, 255), shift(0.5, 0), {&mask});
  EXPECT_TRUE(image::identical(frame, before));
}

TEST(ChromaKey, VirtualImageOfAnotherSizeIsACallersMistake) {
  Picture frame = image::picture_from_rgb8(ramp(), kRgbPlanes);
  EXPECT_THROW(composite_chroma_key(frame, image::make_rgb8(8, 8), Homography::Identity(), {}),
               std::logic_error);
}

}  // namespace
}  // namespace airtruth::composite
