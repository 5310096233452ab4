// SPDX-License-Identifier: Apache-2.0
// What is written and read back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/image/colour.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "picture/video/video_test_folder.h"
#include "picture/video/writer.h"

namespace airtruth::video {
namespace {

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
