// SPDX-License-Identifier: Apache-2.0
#include "picture/video/media_file.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "picture/video/metadata.h"
#include "picture/video/still.h"
#include "picture/video/writer.h"
#include "support/shared_folder.h"
#include "support/source_folder.h"
#include "support/video_folder.h"

namespace airtruth::video {
namespace {

// Whether the document holds each name as `name`.
void expect_documented(std::span<const char* const> names) {
  const std::string text = read_file(test_support::source_folder() / "docs/robustness.md");
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

TEST_F(Video, PicturesHoldNothingBesidesInWhateverFormTheyAreStated) {
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.08 a%d.png");
  write_file(folder_ / "list.txt", "a1.png\na2.png\n");
  for (const char* name : {"", "a%d.png", "list.txt"}) {
    EXPECT_TRUE(read_tags(folder_ / name).empty()) << name;
    EXPECT_TRUE(read_telemetry(folder_ / name).empty()) << name;
    EXPECT_TRUE(read_subtitles(folder_ / name).empty()) << name;
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

// Compares the frames that a reader gives from frame k on, for every `step`th k, with those that
// are counted from the start. Returns the number of readers that had to decode all frames before.
int expect_the_same_frames(const fs::path& video, int step) {
  Reader whole(video, {.threads = 1});
  std::vector<std::string> expected;
  std::vector<std::int64_t> times;
  while (const auto frame = whole.next()) {
    expected.push_back(planes_of(frame->picture));
    times.push_back(frame->pts);
  }
  int decoded_all = 0;
  for (std::size_t k = 1; k < expected.size(); k += static_cast<std::size_t>(step)) {
    const auto count = [&](const std::string& warning) {
      if (warning.find("without decoding") != std::string::npos) ++decoded_all;
    };
    Reader reader(video,
                  {.first_frame = static_cast<std::int64_t>(k), .frame_count = 3, .threads = 1},
                  count);
    for (std::size_t i = k; i < std::min(k + 3, expected.size()); ++i) {
      const auto frame = reader.next();
      EXPECT_TRUE(frame.has_value()) << video << " at frame " << k;
      if (!frame) return decoded_all;
      EXPECT_EQ(frame->pts, times[i]) << video << " at frame " << k;
      EXPECT_TRUE(planes_of(frame->picture) == expected[i]) << video << " at frame " << k;
      EXPECT_EQ(frame->index, static_cast<std::int64_t>(i - k));
    }
  }
  return decoded_all;
}

TEST_F(Video, FramesAreFoundAsTheyAreCountedFromTheStart) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"h264.mp4", "-c:v libx264 -g 10 -bf 3"},
      {"open.mp4", "-c:v libx264 -x264-params open-gop=1:keyint=10:bframes=3:scenecut=0"},
      {"open.ts", "-c:v libx264 -x264-params open-gop=1:keyint=10:bframes=3:scenecut=0"},
      {"h264.mov", "-c:v libx264 -g 7 -bf 2"},
      {"h264.mkv", "-c:v libx264 -g 10 -bf 3"},
      {"h264.ts", "-c:v libx264 -g 10 -bf 2"},
      {"hevc.mp4",
       "-c:v libx265 -x265-params log-level=none:keyint=10:min-keyint=10:open-gop=1:bframes=3"},
      {"vp9.webm", "-c:v libvpx-vp9 -deadline realtime -cpu-used 8 -g 10"},
      {"mpeg4.mp4", "-c:v mpeg4 -g 10 -bf 2"},
      {"ffv1.mkv", "-c:v ffv1"},
      {"prores.mov", "-c:v prores_ks"},
      {"mjpeg.avi", "-c:v mjpeg -pix_fmt yuvj420p"},
      {"h264.avi", "-c:v libx264 -g 10 -bf 0"},
      {"vfr.mp4",
       "-vf \"select='not(eq(n,3)+eq(n,4)+gt(mod(n,7),5))'\" -fps_mode vfr -c:v libx264 -g 10"},
      {"late.mp4", "-c:v libx264 -g 10 -bf 2 -output_ts_offset 7.3"}};
  for (const auto& [file, settings] : cases) {
    ffmpeg(std::string("-f lavfi -i testsrc2=s=66x50:r=25:d=1.8 -pix_fmt yuv420p ") + settings +
           " " + file);
    if (HasFatalFailure()) return;
    EXPECT_EQ(expect_the_same_frames(folder_ / file, 3), 0) << file;
  }
}

// The copy begins within a group of pictures, with an edit list that hides those before.
TEST_F(Video, FramesOfAnEditListAreFound) {
  ffmpeg("-f lavfi -i testsrc2=s=66x50:r=25:d=3 -c:v libx264 -g 12 -bf 2 whole.mp4");
  ffmpeg("-ss 0.7 -i whole.mp4 -c copy cut.mp4");
  EXPECT_EQ(expect_the_same_frames(folder_ / "cut.mp4", 2), 0);
}

// Neither states when each frame is shown.
TEST_F(Video, WhereNoFrameCanBeFoundAllAreDecodedFromTheStartAndThisIsSaid) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"packed.avi", "-c:v mpeg4 -g 5 -bf 2"}, {"program.mpg", "-c:v mpeg2video -g 5 -bf 2"}};
  for (const auto& [file, settings] : cases) {
    ffmpeg(std::string("-f lavfi -i testsrc2=s=66x50:r=25:d=1 ") + settings + " " + file);
    EXPECT_GT(expect_the_same_frames(folder_ / file, 5), 0) << file;
  }
}

// A key packet of the first begins a refresh that takes the following frames; the times of the
// second begin below zero. Some frames of both are decoded from the start.
TEST_F(Video, FramesAreTheSameWhereSomeCannotBeFound) {
  ffmpeg(
      "-f lavfi -i testsrc2=s=66x50:r=25:d=1 -c:v libx264 -x264-params "
      "intra-refresh=1:keyint=12:bframes=0 refresh.ts");
  ffmpeg(
      "-f lavfi -i testsrc2=s=66x50:r=25:d=1 -c:v libx264 -g 10 -bf 2 -avoid_negative_ts disabled "
      "-output_ts_offset -0.5 negative.mkv");
  for (const char* file : {"refresh.ts", "negative.mkv"}) expect_the_same_frames(folder_ / file, 3);
}

TEST_F(Video, PicturesAreFoundByTheirNumber) {
  fs::create_directories(folder_ / "frames");
  ffmpeg("-f lavfi -i testsrc2=s=66x50:r=25:d=0.6 frames/%03d.png");
  EXPECT_EQ(expect_the_same_frames(folder_ / "frames", 2), 0);
  EXPECT_THAT(error_of(folder_ / "frames", {.first_frame = 20}),
              testing::HasSubstr("holds 15 frames; first_frame = 20"));
}

TEST_F(Video, FramesOfTheRealClipsAreFound) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset";
  const fs::path footage = fs::path(shared) / "footage";
  for (const char* clip : {"fixed-wing/cumulus_a4.mp4", "gopro-karma/karma.mp4"})
    for (const int first : {131, 300}) {
      const fs::path video = footage / clip;
      ffmpeg("-i '" + video.string() + "' -vf select='gte(n\\," + std::to_string(first) +
             ")' -frames:v 2 -f rawvideo -fps_mode passthrough found.bin");
      Reader reader(video, {.first_frame = first, .frame_count = 2});
      EXPECT_TRUE(all_planes(reader) == read_file(folder_ / "found.bin")) << clip << first;
    }
}

}  // namespace
}  // namespace airtruth::video
