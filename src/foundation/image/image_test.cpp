// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

#include "foundation/image/colour.h"
#include "foundation/image/picture.h"
#include "foundation/image/sample_memory.h"

namespace airtruth::image {
namespace {

TEST(Srgb, MatchesTheStandardAtKnownPoints) {
  EXPECT_NEAR(linear_from_srgb(0.5f), 0.21404114f, 1e-6f);
  EXPECT_NEAR(srgb_from_linear(0.18f), 0.46135613f, 1e-6f);
  for (int i = 0; i <= 255; ++i) {
    const float coded = static_cast<float>(i) / 255.0f;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(coded)), coded, 1e-5f);
  }
}

TEST(ToneCurve, IsSrgbsUnlessItHasAnExponent) {
  const ToneCurve srgb;
  EXPECT_NEAR(srgb.linear_from_coded(0.5), 0.21404114, 1e-8);
  EXPECT_NEAR(srgb.coded_from_linear(0.18), 0.46135613, 1e-8);
  // The curve has the exponent 2.4. The standard rounds the place where the line ends.
  for (double coded = 0; coded <= 1; coded += 0.01)
    EXPECT_NEAR(ToneCurve{2.4}.linear_from_coded(coded), srgb.linear_from_coded(coded), 2e-6);
}

TEST(ToneCurve, OfAnyExponentIsSmoothAndTurnsBack) {
  for (const double gamma : {1.2, 1.8, 2.2, 3.0}) {
    const ToneCurve tone{gamma};
    EXPECT_DOUBLE_EQ(tone.coded_from_linear(1), 1);
    EXPECT_NEAR(tone.coded_from_linear(0.5), 1.055 * std::pow(0.5, 1 / gamma) - 0.055, 1e-12);
    for (double coded = 0; coded <= 1.5; coded += 0.01)
      EXPECT_NEAR(tone.coded_from_linear(tone.linear_from_coded(coded)), coded, 1e-12) << gamma;
    const double end = 0.055 / (gamma - 1), step = 1e-6;
    const double below = tone.linear_from_coded(end) - tone.linear_from_coded(end - step);
    const double above = tone.linear_from_coded(end + step) - tone.linear_from_coded(end);
    EXPECT_NEAR(above / below, 1, 1e-4) << gamma;
  }
}

// Rec. BT.709-6, item 3.4: red at 100 % in 8-bit limited range is Y 63, Cb 102, Cr 240.
TEST(ColourCode, RedIsWhereTheStandardPutsIt) {
  const Ycc red =
      ColourCode({Chroma::k444, Matrix::kBt709, Range::kLimited}).ycc_from_rgb({1, 0, 0});
  EXPECT_EQ(std::lround(red.y), 63);
  EXPECT_EQ(std::lround(red.cb), 102);
  EXPECT_EQ(std::lround(red.cr), 240);
  const Ycc red601 =
      ColourCode({Chroma::k444, Matrix::kBt601, Range::kFull}).ycc_from_rgb({1, 0, 0});
  EXPECT_EQ(std::lround(red601.y), 76);  // JFIF
  EXPECT_EQ(std::lround(red601.cb), 85);
  EXPECT_NEAR(red601.cr, 255.5f, 1e-3f);
}

TEST(ColourCode, RoundTripsForEveryMatrixAndRange) {
  for (Matrix matrix : {Matrix::kRgb, Matrix::kBt601, Matrix::kBt709, Matrix::kBt2020}) {
    for (Range range : {Range::kLimited, Range::kFull}) {
      const ColourCode colour_code({Chroma::k444, matrix, range});
      for (float y = 0; y < 256; y += 51) {
        for (float cb = 3; cb < 256; cb += 50) {
          const Ycc back = colour_code.ycc_from_rgb(colour_code.rgb_from_ycc({y, cb, 255 - cb}));
          EXPECT_NEAR(back.y, y, 1e-3f);
          EXPECT_NEAR(back.cb, cb, 1e-3f);
          EXPECT_NEAR(back.cr, 255 - cb, 1e-3f);
        }
      }
    }
  }
}

TEST(Luma, OfRedGreenAndBlueIsThatOfBt601AndElseTheFirstPlane) {
  Rgb8 rgb = make_rgb8(70, 3);
  for (int i = 0; i < 3 * 70 * 3; ++i)
    rgb.samples[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(37 * i % 256);
  for (int c = 0; c < 3; ++c) rgb.at(5, 1)[c] = 255;
  for (const Matrix matrix : {Matrix::kRgb, Matrix::kBt709}) {
    const Picture picture = picture_from_rgb8(rgb, {Chroma::k444, matrix, Range::kFull});
    std::array<std::uint8_t, 66> row;
    copy_luma(picture, 3, 1, 66, row.data());
    for (int x = 3; x < 69; ++x) {
      const std::uint8_t* at = rgb.at(x, 1);
      const double expected = matrix == Matrix::kRgb
                                  ? 0.299 * at[0] + 0.587 * at[1] + 0.114 * at[2]
                                  : static_cast<double>(picture.planes[0].row(1)[x]);
      EXPECT_NEAR(luma_at(picture, x, 1), expected, 0.51) << x;
      EXPECT_EQ(row[static_cast<std::size_t>(x - 3)], luma_at(picture, x, 1)) << x;
    }
    EXPECT_EQ(luma_at(picture, 5, 1), 255);
  }
}

TEST(Picture, OddSizesRoundChromaUp) {
  const Picture picture = make_picture(5, 3, {Chroma::k420});
  EXPECT_EQ(picture.planes[1].width, 3);
  EXPECT_EQ(picture.planes[1].height, 2);
  EXPECT_EQ(make_picture(5, 3, {Chroma::k422}).planes[2].height, 3);
  EXPECT_EQ(make_picture(5, 3, {Chroma::kNone}).plane_count, 1);
}

TEST(Picture, CloneIsIdenticalUntilASampleChanges) {
  Picture picture = picture_from_rgb8(make_rgb8(7, 5), {Chroma::k420});
  Picture copy = picture.clone();
  EXPECT_TRUE(identical(picture, copy));
  copy.planes[2].row(2)[3] ^= 1;
  EXPECT_FALSE(identical(picture, copy));
}

TEST(Rgb8, ThroughYcc444AndBackWithinOneLevel) {
  Rgb8 rgb = make_rgb8(16, 16);
  for (int i = 0; i < 16 * 16; ++i) {
    rgb.samples[static_cast<std::size_t>(3 * i)] = static_cast<std::uint8_t>(i);
    rgb.samples[static_cast<std::size_t>(3 * i + 1)] = static_cast<std::uint8_t>(255 - i);
    rgb.samples[static_cast<std::size_t>(3 * i + 2)] = static_cast<std::uint8_t>((7 * i) % 256);
  }
  const Rgb8 back =
      rgb8_from_picture(picture_from_rgb8(rgb, {Chroma::k444, Matrix::kBt601, Range::kFull}));
  for (std::size_t i = 0; i < 16 * 16 * 3; ++i) EXPECT_NEAR(back.samples[i], rgb.samples[i], 1);
  const Rgb8 exact =
      rgb8_from_picture(picture_from_rgb8(rgb, {Chroma::k444, Matrix::kRgb, Range::kFull}));
  for (std::size_t i = 0; i < 16 * 16 * 3; ++i) EXPECT_EQ(exact.samples[i], rgb.samples[i]);
}

TEST(Rgb8, IsTheRoundedColourOfEachSample) {
  for (const Matrix matrix : {Matrix::kRgb, Matrix::kBt601, Matrix::kBt709, Matrix::kBt2020}) {
    for (const Range range : {Range::kLimited, Range::kFull}) {
      const Colour colour{Chroma::k444, matrix, range};
      const ColourCode code(colour);
      Picture picture = make_picture(255, 27, colour);  // no multiple of a block
      for (int cr = 0; cr < 256; cr += 15) {
        for (int x = 0; x < 255; ++x) {
          for (int y = 0; y < 27; ++y) {
            picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(x);
            picture.planes[1].row(y)[x] = static_cast<std::uint8_t>(9 * y);
            picture.planes[2].row(y)[x] = static_cast<std::uint8_t>(cr);
          }
        }
        const Rgb8 packed = rgb8_from_picture(picture);
        for (int x = 0; x < 255; ++x) {
          for (int y = 0; y < 27; ++y) {
            const Rgb rgb = code.rgb_from_ycc({float(x), float(9 * y), float(cr)});
            for (std::size_t c = 0; c < 3; ++c)
              ASSERT_EQ(packed.at(x, y)[c], int(std::clamp(255 * rgb[c], 0.0f, 255.0f) + 0.5f))
                  << x << ' ' << 9 * y << ' ' << cr;
          }
        }
      }
    }
  }
}

// Of odd sizes, where a block of chroma is cut by the edge and its last pixels are repeated.
TEST(Rgb8, APictureHasTheRoundedMeanChromaOfItsBlocks) {
  constexpr int kWidth = 133, kHeight = 37;
  Rgb8 rgb = make_rgb8(kWidth, kHeight);
  unsigned state = 1;
  for (int i = 0; i < 3 * kWidth * kHeight; ++i)
    rgb.samples[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>((state = state * 1664525u + 1013904223u) >> 24);
  for (const Chroma chroma : {Chroma::kNone, Chroma::k420, Chroma::k422, Chroma::k440}) {
    const Colour colour{chroma, Matrix::kBt709, Range::kLimited};
    const ColourCode code(colour);
    const Picture picture = picture_from_rgb8(rgb, colour);
    const auto ycc = [&](int x, int y) {
      const std::uint8_t* p = rgb.at(std::min(x, kWidth - 1), std::min(y, kHeight - 1));
      return code.ycc_from_rgb({p[0] / 255.0f, p[1] / 255.0f, p[2] / 255.0f});
    };
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        ASSERT_EQ(picture.planes[0].row(y)[x], int(ycc(x, y).y + 0.5f));
    for (std::size_t i = 1; i < static_cast<std::size_t>(picture.plane_count); ++i) {
      const int w = 1 << log2_chroma_width(chroma), h = 1 << log2_chroma_height(chroma);
      for (int y = 0; y < picture.planes[i].height; ++y) {
        for (int x = 0; x < picture.planes[i].width; ++x) {
          double sum = 0;
          for (int n = 0; n < w * h; ++n) {
            const Ycc one = ycc(w * x + n % w, h * y + n / w);
            sum += static_cast<double>(i == 1 ? one.cb : one.cr);
          }
          ASSERT_NEAR(picture.planes[i].row(y)[x], sum / (w * h), 0.5001);
        }
      }
    }
  }
}

TEST(Rgb8, APartBeyondThePictureIsBlack) {
  Picture picture = make_picture(20, 6, {Chroma::k420, Matrix::kBt601, Range::kFull});
  for (Plane& plane : picture.planes)
    for (int y = 0; y < plane.height; ++y) std::fill_n(plane.row(y), plane.width, 128);
  const Rgb8 part = rgb8_from_picture(picture, {-3, -2, 30, 10});
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 30; ++x)
      EXPECT_EQ(part.at(x, y)[1], x >= 3 && x < 23 && y >= 2 && y < 8 ? 128 : 0) << x << ' ' << y;
}

Picture with_numbered_samples(int width, int height, Chroma chroma) {
  Picture picture = make_picture(width, height, {chroma});
  int next = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(picture.plane_count); ++i)
    for (int y = 0; y < picture.planes[i].height; ++y)
      for (int x = 0; x < picture.planes[i].width; ++x)
        picture.planes[i].row(y)[x] = static_cast<std::uint8_t>(7 * next++ % 251);
  return picture;
}

TEST(Crop, TakesEverySampleOfTheBoxAndPasteBringsItBack) {
  for (const Chroma chroma :
       {Chroma::kNone, Chroma::k420, Chroma::k422, Chroma::k440, Chroma::k444}) {
    const Picture whole = with_numbered_samples(37, 29, chroma);
    const PixelBox box{12, 8, 25, 21};  // reaches the odd-sized picture's far corner
    const Picture part = crop(whole, box);
    for (int y = 0; y < box.height; ++y)
      for (int x = 0; x < box.width; ++x)
        ASSERT_EQ(part.luma().row(y)[x], whole.luma().row(box.y + y)[box.x + x]);
    if (whole.plane_count == 3) {
      const int cx = 12 >> log2_chroma_width(chroma), cy = 8 >> log2_chroma_height(chroma);
      EXPECT_EQ(part.planes[2].row(3)[2], whole.planes[2].row(cy + 3)[cx + 2]);
    }
    Picture other = make_picture(37, 29, {chroma});
    for (const PixelBox& tile : {PixelBox{0, 0, 12, 29}, PixelBox{12, 0, 25, 8}, box})
      paste(other, crop(whole, tile), tile.x, tile.y);
    EXPECT_TRUE(identical(other, whole));
  }
}

TEST(Paste, LeavesOutWhatLiesBeyondThePicture) {
  const Picture part = with_numbered_samples(8, 8, Chroma::k420);
  Picture picture = with_numbered_samples(16, 16, Chroma::k420);
  const Picture before = picture.clone();
  paste(picture, part, 20, -8);
  EXPECT_TRUE(identical(picture, before));
  paste(picture, part, -4, 12);
  EXPECT_EQ(picture.luma().row(13)[3], part.luma().row(1)[7]);
  EXPECT_EQ(picture.planes[1].row(7)[1], part.planes[1].row(1)[3]);
  EXPECT_EQ(picture.luma().row(13)[4], before.luma().row(13)[4]);
}

// A block goes from the thread that gave it back to the next that takes one of its size.
TEST(SampleMemory, IsTakenAgainByAnyThread) {
  constexpr std::size_t kBytes = 1'234'567;  // of no other test
  const std::size_t free_before = free_sample_bytes();
  const std::uint8_t* first = nullptr;
  std::thread([&] { first = take_samples(kBytes).get(); }).join();
  EXPECT_EQ(free_sample_bytes(), free_before + kBytes);
  const SampleMemory again = take_samples(kBytes);
  EXPECT_EQ(again.get(), first);
  EXPECT_EQ(free_sample_bytes(), free_before);
  EXPECT_NE(take_samples(kBytes).get(), first);
}

TEST(SampleMemory, KeepsNeitherSmallBlocksNorMoreThanItsLimit) {
  const std::size_t free_before = free_sample_bytes();
  take_samples(1000).reset();
  take_samples(std::size_t{200} << 20).reset();
  EXPECT_EQ(free_sample_bytes(), free_before);
}

}  // namespace
}  // namespace airtruth::image
