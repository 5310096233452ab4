// SPDX-License-Identifier: Apache-2.0
// Files that are cut, damaged or none at all.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"
#include "picture/video/reader.h"
#include "picture/video/video_test_folder.h"

namespace airtruth::video {
namespace {

TEST_F(Video, SaysWhatIsWrongWithAFile) {
  EXPECT_THAT(error_of(folder_ / "none.mp4"), testing::HasSubstr("none.mp4: does not exist"));
  write_file(folder_ / "empty.mp4", "");
  EXPECT_THAT(error_of(folder_ / "empty.mp4"), testing::HasSubstr("is empty"));
  write_file(folder_ / "text.mp4", "this is no video, but it is long enough to be looked at");
  EXPECT_THAT(error_of(folder_ / "text.mp4"), testing::HasSubstr("cannot be read as a video"));
  EXPECT_THAT(error_of(folder_), testing::HasSubstr("folder"));
  ffmpeg("-f lavfi -i sine=d=0.3 sound.m4a");
  EXPECT_THAT(error_of(folder_ / "sound.m4a"), testing::HasSubstr("no video stream"));
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.4 -c:v libx264 whole.mp4");
  const std::string whole = read_file(folder_ / "whole.mp4");
  write_file(folder_ / "cut.mp4", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(error_of(folder_ / "cut.mp4"), testing::HasSubstr("cut.mp4: "));
  EXPECT_THAT(error_of(folder_ / "whole.mp4", {.first_frame = 10}),
              testing::HasSubstr("holds 10 frames"));
}

TEST_F(Video, CorruptPacketsAreFlaggedAndTheRestGoesOn) {
  ffmpeg("-f lavfi -i testsrc2=s=160x120:r=25:d=2 -c:v libx264 -g 10 -bf 0 whole.mkv");
  std::string bytes = read_file(folder_ / "whole.mkv");
  Random random(5);
  const std::size_t middle = bytes.size() / 2;
  for (std::size_t i = 0; i < 400; ++i) bytes[middle + i] = static_cast<char>(random());
  write_file(folder_ / "bad.mkv", bytes);
  Reader reader(folder_ / "bad.mkv");
  int frames = 0;
  int damaged = 0;
  bool last_damaged = true;
  while (const auto frame = reader.next()) {
    ++frames;
    damaged += frame->damaged ? 1 : 0;
    last_damaged = frame->damaged;
  }
  EXPECT_GT(frames, 35);
  EXPECT_GT(damaged + (50 - frames), 0);
  EXPECT_LT(damaged, 30);
  EXPECT_FALSE(last_damaged);
}

TEST_F(Video, TruncatedStreamEndsEarly) {
  ffmpeg("-f lavfi -i testsrc2=s=160x120:r=25:d=2 -c:v libx264 -movflags +faststart whole.mp4");
  const std::string bytes = read_file(folder_ / "whole.mp4");
  write_file(folder_ / "cut.mp4", bytes.substr(0, bytes.size() * 2 / 3));
  Reader reader(folder_ / "cut.mp4");
  int frames = 0;
  all_planes(reader, &frames);
  EXPECT_GT(frames, 5);
  EXPECT_LT(frames, 50);
  EXPECT_TRUE(reader.ends_early());
}

TEST_F(Video, TruncatedMatroskaEndsEarlyToo) {
  ffmpeg("-f lavfi -i testsrc2=s=160x120:r=25:d=4 -c:v libx264 -g 5 whole.mkv");
  const std::string bytes = read_file(folder_ / "whole.mkv");
  write_file(folder_ / "cut.mkv", bytes.substr(0, bytes.size() / 2));
  Reader cut(folder_ / "cut.mkv");
  Reader whole(folder_ / "whole.mkv");
  all_planes(cut);
  all_planes(whole);
  EXPECT_TRUE(cut.ends_early());
  EXPECT_FALSE(whole.ends_early());
}

}  // namespace
}  // namespace airtruth::video
