// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/clips.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dataset/labelled/import.h"
#include "support/video_folder.h"

namespace airtruth::runs {
namespace {

class Clips : public video::Video {};

// The cut at frame 10 lies between two labelled frames.
TEST_F(Clips, ACutBetweenLabelledFramesBeginsAShot) {
  ffmpeg(
      "-f lavfi -i color=0x404040:s=160x120:r=25:d=0.4 -f lavfi -i testsrc=s=160x120:r=25:d=0.4 "
      "-filter_complex [0][1]concat=n=2,format=yuv420p -c:v ffv1 cut.mkv");
  DetectionClip clip;
  clip.name = "cut";
  clip.media = folder_ / "cut.mkv";
  clip.frames = {0, 4, 8, 12, 16};
  ClipFrames frames(clip, true, {});
  std::vector<std::int64_t> beginnings;
  while (const auto frame = frames.next())
    if (frame->begins_shot) beginnings.push_back(frame->index);
  EXPECT_THAT(beginnings, testing::ElementsAre(0, 3));
}

TEST_F(Clips, TheRateIsThatOfTheLabelledFrames) {
  ffmpeg("-f lavfi -i testsrc=s=64x48:r=25:d=0.4 -c:v ffv1 v.mkv");
  write_file(folder_ / "a.json",
             R"({"categories":[{"id":1,"name":"aircraft"}],"annotations":[],"images":[
                 {"id":1,"file_name":"a/000000.jpg","width":64,"height":48},
                 {"id":2,"file_name":"a/000005.jpg","width":64,"height":48}]})");
  labelled::ImportOptions options;
  options.format = exchange::Format::kCoco;
  options.videos[""] = folder_ / "v.mkv";
  labelled::import_set(folder_ / "a.json", folder_ / "set", options);
  const DetectionClip clip = clip_of(labelled::LabelledSet(folder_ / "set"), "a");
  EXPECT_DOUBLE_EQ(ClipFrames(clip, false, {}).sequence().frame_rate_hz, 5);
}

}  // namespace
}  // namespace airtruth::runs
