// SPDX-License-Identifier: Apache-2.0
#include "picture/video/writer.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"
#include "foundation/image/colour.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "support/video_folder.h"

namespace airtruth::video {
namespace {

constexpr int kWidth = 70, kHeight = 38;  // neither a multiple of 16 nor of 32

Frame noise(std::int64_t index, const image::Colour& colour) {
  Frame frame;
  frame.index = frame.pts = index;
  frame.picture = image::make_picture(kWidth, kHeight, colour);
  Random random(static_cast<std::uint64_t>(index));
  for (int i = 0; i < frame.picture.plane_count; ++i) {
    image::Plane& plane = frame.picture.planes[static_cast<std::size_t>(i)];
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x)
        plane.row(y)[x] = static_cast<std::uint8_t>(random() % 256);
  }
  return frame;
}

StreamInfo stream_of(const image::Colour& colour) {
  StreamInfo info;
  info.width = kWidth;
  info.height = kHeight;
  info.colour = colour;
  return info;
}

fs::path written(const fs::path& file, const WriterOptions& options, std::string* encoder) {
  Writer writer(file, stream_of({}), options);
  for (std::int64_t k = 0; k < 20; ++k) writer.write(noise(k, {}));
  writer.finish();
  *encoder = writer.encoder();
  return file;
}

TEST_F(Video, AutoIsX264WithItsBytesWhereNoHardwareEncodes) {
  std::string encoder;
  const fs::path x264 = written(folder_ / "x264.mp4", {}, &encoder);
  EXPECT_EQ(encoder, "libx264");
  const fs::path any = written(folder_ / "auto.mp4", {.encoder = Encoder::kAuto}, &encoder);
  EXPECT_GT(fs::file_size(any), 1000u);
  if (encoder != "libx264") GTEST_SKIP() << "this machine encodes by " << encoder;
  EXPECT_EQ(sha256_of_file(any), sha256_of_file(x264));
}

TEST_F(Video, AMissingEncoderIsAnErrorAtItsPlace) {
  image::Colour colour;
  colour.chroma = image::Chroma::k444;  // none of them takes it, whatever the machine has
  for (const auto& [encoder, name] : {std::pair(Encoder::kNvenc, "h264_nvenc"),
                                      std::pair(Encoder::kVaapi, "h264_vaapi"),
                                      std::pair(Encoder::kQsv, "h264_qsv")}) {
    const WriterOptions options{.encoder = encoder, .encoder_where = {"s.toml", 12, 11}};
    const fs::path file = folder_ / "hardware.mp4";
    try {
      const Writer writer(file, stream_of(colour), options);
      ADD_FAILURE() << name << " took 4:4:4";
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find("s.toml:12:11: encoder " + std::string(name)), 0u)
          << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
    EXPECT_TRUE(fs::is_empty(folder_));
  }
}

TEST_F(Video, LosslessOutputGivesEverySampleBack) {
  for (const char* format : {"yuv420p", "yuv422p", "yuv444p", "yuv440p", "gray", "yuvj420p"}) {
    ffmpeg(std::string("-f lavfi -i testsrc=s=67x51:r=25:d=0.2 -vf format=rgb24,format=") + format +
           " -c:v " + (std::string(format) == "yuvj420p" ? "mjpeg" : "ffv1") +
           " -strict -1 in.mkv");
    Reader reader(folder_ / "in.mkv");
    {
      Writer writer(folder_ / "out.mkv", reader.info(), {.format = Format::kMkv});
      while (const auto frame = reader.next()) writer.write(*frame);
      writer.finish();
    }
    Reader a(folder_ / "in.mkv");
    Reader b(folder_ / "out.mkv");
    EXPECT_TRUE(all_planes(a) == all_planes(b)) << format;
    EXPECT_EQ(a.info().colour.range, b.info().colour.range) << format;
    EXPECT_EQ(a.info().colour.chroma, b.info().colour.chroma) << format;
  }
}

// JPEG is of BT.601 and full range (ITU-T T.871), and AVI states no other; ffmpeg reads it so.
TEST_F(Video, AviKeepsTheColoursOfEveryMatrixAndRange) {
  constexpr std::array<std::uint8_t, 3> kRed = {189, 32, 29};
  image::Rgb8 red = image::make_rgb8(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) std::copy(kRed.begin(), kRed.end(), red.at(x, y));
  for (const image::Matrix matrix :
       {image::Matrix::kBt601, image::Matrix::kBt709, image::Matrix::kBt2020, image::Matrix::kRgb})
    for (const image::Range range : {image::Range::kLimited, image::Range::kFull}) {
      const bool is_rgb = matrix == image::Matrix::kRgb;
      const image::Colour colour{is_rgb ? image::Chroma::k444 : image::Chroma::k420, matrix, range};
      Frame frame;
      frame.picture = image::picture_from_rgb8(red, colour);
      Writer writer(folder_ / "red.avi", stream_of(colour), {.format = Format::kAvi});
      writer.write(frame);
      writer.finish();
      const std::string shown = raw("red.avi", "rgb24");
      ASSERT_EQ(shown.size(), red.bytes().size());
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(static_cast<unsigned char>(shown[c]), kRed[c], 4)
            << static_cast<int>(matrix) << static_cast<int>(range);
    }
}

TEST_F(Video, AviRefusesAVariableFrameRate) {
  ffmpeg(
      "-f lavfi -i testsrc2=s=64x48:r=25:d=0.6 -vf \"select='not(eq(n,3)+eq(n,4)+eq(n,9))'\" "
      "-fps_mode vfr -c:v libx264 vfr.mp4");
  const StreamInfo info = Reader(folder_ / "vfr.mp4").info();
  EXPECT_THAT(
      test_support::error_of([&] { Writer(folder_ / "out.avi", info, {.format = Format::kAvi}); }),
      testing::HasSubstr("avi cannot hold the times of a variable frame rate; "
                         "expected mp4 or mkv"));
  EXPECT_FALSE(fs::exists(part_path(folder_ / "out.avi")));
}

// Thirty frames of 30000/1001 per second with these time stamps; one more frame is missing from
// each of the frames `missing` on. "no error" where they are written.
std::string avi_error(const fs::path& file, Rational time_base, std::vector<int> missing) {
  StreamInfo info = stream_of({});
  info.frame_rate = {30000, 1001};
  info.time_base = time_base;
  return test_support::error_of([&] {
    Writer writer(file, info, {.format = Format::kAvi});
    for (int k = 0; k < 30; ++k) {
      Frame frame = noise(0, {});
      const auto place = k + std::ranges::count_if(missing, [&](int from) { return from <= k; });
      frame.pts =
          7 + std::lround(static_cast<double>(place) / info.frame_rate.value() / time_base.value());
      writer.write(frame);
    }
    writer.finish();
  });
}

TEST_F(Video, AviRefusesTimesThatDepartFromItsRateByMoreThanAFrame) {
  for (const Rational& time_base : {Rational{1, 90000}, Rational{1, 1000}, Rational{1001, 30000}}) {
    EXPECT_EQ(avi_error(folder_ / "whole.avi", time_base, {}), "no error");
    EXPECT_EQ(avi_error(folder_ / "one.avi", time_base, {12}), "no error");
    EXPECT_THAT(avi_error(folder_ / "two.avi", time_base, {12, 20}),
                testing::HasSubstr("avi cannot hold the times of a variable frame rate (frame 20 "
                                   "is 2.0 frames later than at 29.97 frames/s)"));
    EXPECT_FALSE(fs::exists(folder_ / "two.avi"));
  }
}

TEST_F(Video, NumberedImagesNeverReplaceAFolder) {
  fs::create_directories(folder_ / "frames");
  write_file(folder_ / "frames/user.txt", "mine");
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -c:v libx264 in.mp4");
  Reader reader(folder_ / "in.mp4");
  EXPECT_THROW(Writer(folder_ / "frames", reader.info(), {.format = Format::kPng}), Error);
  EXPECT_EQ(read_file(folder_ / "frames/user.txt"), "mine");
}

TEST_F(Video, WriterLeavesNothingUnlessFinished) {
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -c:v libx264 in.mp4");
  Reader reader(folder_ / "in.mp4");
  {
    Writer writer(folder_ / "out.mp4", reader.info(), {});
    writer.write(*reader.next());
  }
  EXPECT_FALSE(fs::exists(folder_ / "out.mp4"));
  EXPECT_FALSE(fs::exists(part_path(folder_ / "out.mp4")));
}

TEST_F(Video, SameFramesGiveTheSameFileOnAnyNumberOfThreads) {
  ffmpeg("-f lavfi -i testsrc2=s=640x480:r=25:d=2 -c:v libx264 in.mp4");
  for (Format format : {Format::kMp4, Format::kMkv, Format::kAvi}) {
    std::vector<std::string> sums;
    for (int round = 0; round < 2; ++round) {
      Reader reader(folder_ / "in.mp4");
      const fs::path out = folder_ / (std::string("out") + extension(format));
      Writer writer(out, reader.info(), {.format = format, .threads = 1 + 2 * round});
      while (const auto frame = reader.next()) writer.write(*frame);
      writer.finish();
      sums.push_back(sha256_of_file(out));
    }
    EXPECT_EQ(sums[0], sums[1]) << extension(format);
  }
}

TEST_F(Video, FullDiskIsAnErrorThatSaysSo) {
  if (::geteuid() != 0) GTEST_SKIP() << "mounting a small file system needs root";
  const fs::path small = folder_ / "small";
  fs::create_directories(small);
  if (std::system(
          ("mount -t tmpfs -o size=64k tmpfs '" + small.string() + "' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << "no small file system can be mounted here";
  ffmpeg("-f lavfi -i testsrc2=s=320x240:r=25:d=1 -c:v libx264 in.mp4");
  std::string message;
  try {
    Reader reader(folder_ / "in.mp4");
    Writer writer(small / "out.mkv", reader.info(), {.format = Format::kMkv});
    while (const auto frame = reader.next()) writer.write(*frame);
    writer.finish();
  } catch (const Error& error) {
    message = error.what();
  }
  EXPECT_THAT(message, testing::HasSubstr("No space left on device"));
  EXPECT_TRUE(fs::is_empty(small));
  EXPECT_EQ(std::system(("umount '" + small.string() + "'").c_str()), 0);
}

}  // namespace
}  // namespace airtruth::video
