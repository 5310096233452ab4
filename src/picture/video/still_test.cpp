// SPDX-License-Identifier: Apache-2.0
// Single pictures and masks.
#include "picture/video/still.h"

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/image/colour.h"
#include "picture/video/reader.h"
#include "support/video_folder.h"

namespace airtruth::video {
namespace {

// A .jpg of a decoded picture has the picture's colours, whatever their coding.
TEST_F(Video, JpegsOfPicturesKeepTheirColours) {
  image::Rgb8 rgb = image::make_rgb8(96, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      rgb.at(x, y)[0] = static_cast<std::uint8_t>(40 + 2 * x);
      rgb.at(x, y)[1] = static_cast<std::uint8_t>(30 + 3 * y);
      rgb.at(x, y)[2] = static_cast<std::uint8_t>(220 - x - y);
    }
  using image::Chroma;
  using image::Matrix;
  for (const Chroma chroma : {Chroma::k420, Chroma::k422, Chroma::k444})
    for (const Matrix matrix : {Matrix::kBt601, Matrix::kBt709, Matrix::kBt2020, Matrix::kRgb})
      for (const image::Range range : {image::Range::kLimited, image::Range::kFull}) {
        if (matrix == Matrix::kRgb && (chroma != Chroma::k444 || range == image::Range::kLimited))
          continue;
        const image::Picture picture =
            image::picture_from_rgb8(rgb, {chroma, matrix, range, image::Siting::kCenter});
        write_still(folder_ / "c.jpg", picture);
        const image::Rgb8 back = read_still(folder_ / "c.jpg");
        double sum = 0;
        for (int i = 0; i < 3 * 96 * 64; ++i) sum += std::abs(back.at(0, 0)[i] - rgb.at(0, 0)[i]);
        EXPECT_LT(sum / (3 * 96 * 64), 2.0)
            << int(chroma) << ' ' << int(matrix) << ' ' << int(range);
      }
}

TEST_F(Video, StillsAndMasks) {
  image::Rgb8 rgb = image::make_rgb8(33, 21);
  for (int i = 0; i < 33 * 21 * 3; ++i)
    rgb.samples[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i * 7);
  write_still(folder_ / "a.png", rgb);
  const image::Rgb8 back = read_still(folder_ / "a.png");
  EXPECT_TRUE(std::equal(rgb.samples.get(), rgb.samples.get() + 33 * 21 * 3, back.samples.get()));
  write_still(folder_ / "a.jpg", rgb);
  EXPECT_EQ(read_still(folder_ / "a.jpg").width, 33);
  EXPECT_THROW(read_mask(folder_ / "a.png", 32, 21), Error);
  write_still(folder_ / "black.png", image::make_rgb8(8, 8));
  EXPECT_THROW(read_mask(folder_ / "black.png", 8, 8), Error);
  image::Rgb8 half = image::make_rgb8(8, 8);
  std::fill_n(half.samples.get(), 8 * 4 * 3, std::uint8_t{255});
  // (red + 2 green + blue) / 4 of these is 127 and 128.
  half.at(0, 0)[0] = 1, half.at(1, 0)[0] = 2;
  half.at(0, 0)[2] = half.at(1, 0)[2] = 0;
  write_still(folder_ / "half.png", half);
  const image::Mask mask = read_mask(folder_ / "half.png", 8, 8);
  EXPECT_TRUE(mask.is_free(3, 3));
  EXPECT_FALSE(mask.is_free(3, 4));
  EXPECT_FALSE(mask.is_free(0, 0));
  EXPECT_TRUE(mask.is_free(1, 0));
}

// Largest difference between two sets of samples; 256 where their sizes differ.
int worst(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return 256;
  int most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most,
                    std::abs(static_cast<unsigned char>(a[i]) - static_cast<unsigned char>(b[i])));
  return most;
}

// The planes G, B, R of packed R, G, B.
std::string planar(const std::string& packed) {
  std::string result;
  for (const std::size_t channel : {1u, 2u, 0u})
    for (std::size_t i = channel; i < packed.size(); i += 3) result += packed[i];
  return result;
}

// Compares each with ffmpeg's output, to one step: sixteen bits may be rounded either way.
TEST_F(Video, ReadsStillsOfEveryDepth) {
  const std::string source = "-f lavfi -i testsrc=size=46x30:rate=1 -frames:v 1 ";
  for (const char* format : {"pal8", "rgb48be", "rgba64be", "rgba", "rgb24"}) {
    ffmpeg(source + "-pix_fmt " + format + " still.png");
    Reader reader(folder_ / "still.png");
    ASSERT_EQ(reader.info().colour.matrix, image::Matrix::kRgb) << format;
    EXPECT_LE(worst(all_planes(reader), planar(raw("still.png", "rgb24"))), 1) << format;
  }
  for (const char* format : {"monob", "gray16be", "gray", "ya8"}) {
    ffmpeg(source + "-pix_fmt " + format + " still.png");
    Reader reader(folder_ / "still.png");
    ASSERT_EQ(reader.info().colour.chroma, image::Chroma::kNone) << format;
    EXPECT_LE(worst(all_planes(reader), raw("still.png", "gray")), 1) << format;
  }
}

TEST_F(Video, AMaskOfOneBitIsAMask) {
  ffmpeg(
      "-f lavfi -i color=white:size=16x8,drawbox=x=0:y=0:w=4:h=8:color=black:t=fill -frames:v 1 "
      "-pix_fmt monob m.png");
  const image::Mask mask = read_mask(folder_ / "m.png", 16, 8);
  EXPECT_FALSE(mask.is_free(3, 4));
  EXPECT_TRUE(mask.is_free(4, 4));
}

}  // namespace
}  // namespace airtruth::video
