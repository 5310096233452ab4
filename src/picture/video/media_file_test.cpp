// SPDX-License-Identifier: Apache-2.0
#include "picture/video/media_file.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "picture/video/metadata.h"
#include "picture/video/still.h"
#include "picture/video/writer.h"
#include "support/video_folder.h"

namespace airtruth::video {
namespace {

// Whether the document holds each name as `name`.
void expect_documented(std::span<const char* const> names) {
  const std::string text =
      read_file(fs::path(__FILE__).parent_path() / "../../../docs/robustness.md");
  for (const char* name : names)
    EXPECT_NE(text.find("`" + std::string(name) + "`"), std::string::npos) << name;
}

TEST(MediaFile, WhatARunCanReachIsInTheDocument) {
  expect_documented(readable_containers());
  expect_documented(readable_codecs());
}

TEST(MediaFile, EveryNameOfTheListsIsOneOfLibav) {
  for (const char* name : readable_containers())
    EXPECT_NE(av_find_input_format(name), nullptr) << name;
  for (const char* name : readable_codecs())
    EXPECT_NE(avcodec_find_decoder_by_name(name), nullptr) << name;
}

TEST_F(Video, AListOfOtherFilesIsNoVideo) {
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -c:v libx264 part.ts");
  write_file(folder_ / "hls.mp4",
             "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\npart.ts\n#EXT-X-ENDLIST\n");
  write_file(folder_ / "concat.mkv", "ffconcat version 1.0\nfile part.ts\n");
  write_file(folder_ / "drawing.mp4",
             "<?xml version=\"1.0\"?><svg xmlns=\"http://www.w3.org/2000/svg\" width=\"64\" "
             "height=\"48\"></svg>\n");
  write_file(folder_ / "session.mp4", "v=0\no=- 0 0 IN IP4 127.0.0.1\nm=video 5004 RTP/AVP 96\n");
  for (const char* name : {"hls.mp4", "concat.mkv", "drawing.mp4", "session.mp4"}) {
    const std::string error = error_of(folder_ / name);
    EXPECT_THAT(error,
                testing::AnyOf(testing::HasSubstr("expected a video"),
                               testing::HasSubstr("cannot be read as a video")))
        << name;
    EXPECT_THROW(read_tags(folder_ / name), Error) << name;
    EXPECT_THROW(read_still(folder_ / name), Error) << name;
  }
}

TEST_F(Video, APathIsNoAddress) {
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -c:v libx264 plain.mp4");
  Reader plain(folder_ / "plain.mp4");
  const std::string expected = all_planes(plain);
  for (const char* name : {"12:30.mp4", "concat:plain.mp4", "a%03d.mp4", "http:x.mp4"}) {
    fs::copy_file(folder_ / "plain.mp4", folder_ / name);
    Reader reader(folder_ / name);
    EXPECT_TRUE(all_planes(reader) == expected) << name;
    Reader again(folder_ / "plain.mp4");
    const fs::path copy = folder_ / (std::string("copy:") + name);
    Writer writer(copy, again.info(), {});
    while (const auto frame = again.next()) writer.write(*frame);
    writer.finish();
    EXPECT_TRUE(fs::is_regular_file(copy));
  }
}

TEST_F(Video, APictureBeyondTheLimitIsRefusedBeforeItIsDecoded) {
  ffmpeg("-f lavfi -i color=gray:s=9000x9000 -frames:v 1 -c:v png -pix_fmt gray large.mkv");
  ffmpeg("-f lavfi -i color=gray:s=9000x9000 -frames:v 1 -pix_fmt gray large.png");
  EXPECT_THAT(error_of(folder_ / "large.mkv"),
              testing::HasSubstr("9000x9000 px; expected at most"));
  for (const bool with_timing : {true, false})
    EXPECT_THAT(error_of(folder_ / "large.png", {.with_timing = with_timing}),
                testing::HasSubstr("at most 67 million px"));
  EXPECT_THROW(size_of_still(folder_ / "large.png"), Error);
}

TEST_F(Video, LongAndNarrowPicturesAreRead) {
  for (const char* size : {"16384x64", "64x8192", "1920x8", "16x16"}) {
    ffmpeg(std::string("-f lavfi -i testsrc2=r=25:d=0.08:s=") + size + " -c:v ffv1 narrow.mkv");
    Reader reader(folder_ / "narrow.mkv");
    EXPECT_TRUE(all_planes(reader) == raw("narrow.mkv", "yuv420p")) << size;
  }
}

}  // namespace
}  // namespace airtruth::video
