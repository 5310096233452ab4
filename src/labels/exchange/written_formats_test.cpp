// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/tar/tar.h"
#include "labels/exchange/exchange.h"
#include "support/exchange_formats.h"

namespace airtruth::exchange {
namespace {

// Origins, computed by hand: a box whose first pixel is the picture's first, 3 wide and 2 high.
class Origin : public ::testing::Test {
 protected:
  std::string written(Format format, const std::string& file) {
    Clip clip;
    clip.name = "s";
    clip.width = 20;
    clip.height = 10;
    clip.frame_rate_hz = 25;
    Label label;
    label.category = "738";
    label.box_px = {0, 0, 3, 2};
    label.visible = 0.5;
    label.range_m = 700;
    clip.frames = {{0, 0.0, {label}}, {1, 0.04, {}}, {2, 0.08, {label}}};
    auto writer = make_writer(format, folder_.path(), {{"738"}, {"train"}, ".jpg"});
    for (const Clip& one : arranged(format, clip)) {
      first_image_ = writer->images(one, "train").at(0);
      writer->add(one, "train");
    }
    writer->finish();
    return read_file(folder_.path() / file);
  }
  Folder folder_;
  fs::path first_image_;
};

TEST_F(Origin, YoloIsSharesOfThePictureWithAnEmptyFileForNothing) {
  EXPECT_EQ(written(Format::kYolo, "labels/train/s_000000.txt"), "0 0.075 0.1 0.15 0.2\n");
  EXPECT_EQ(read_file(folder_.path() / "labels/train/s_000001.txt"), "");
  EXPECT_EQ(first_image_, "images/train/s_000000.jpg");
  EXPECT_EQ(read_file(folder_.path() / "data.yaml"),
            "# Change `path` when the folder is moved.\npath: \"" + folder_.path().string() +
                "\"\ntrain: images/train\nval: images/train\nnames:\n  0: \"738\"\n");
  EXPECT_TRUE(fs::is_directory(folder_.path() / "images/train"));
}

TEST_F(Origin, MotCountsFramesAndPixelsFromOne) {
  EXPECT_EQ(written(Format::kMot, "train/s/gt/gt.txt"),
            "1,1,1,1,3,2,1,1,0.5,700\n3,1,1,1,3,2,1,1,0.5,700\n");
  EXPECT_EQ(first_image_, "train/s/img1/000001.jpg");
}

TEST_F(Origin, MotHasClass1ForEveryAircraftUnlessAsked) {
  Clip clip;
  clip.name = "s";
  clip.frame_rate_hz = 30000.0 / 1001;
  Label first, second;
  first.category = "738";
  second.category = "c172";
  second.track = 2;
  first.box_px = second.box_px = {0, 0, 3, 2};
  clip.frames = {{0, 0.0, {first, second}}};
  for (const bool asked : {false, true}) {
    const fs::path root = folder_.path() / (asked ? "asked" : "not");
    WriteOptions options{{"738", "c172"}, {"train"}, ".jpg"};
    options.mot_classes = asked;
    auto writer = make_writer(Format::kMot, root, options);
    writer->add(clip, "train");
    writer->finish();
    const std::string type = asked ? "2" : "1";
    EXPECT_EQ(read_file(root / "train/s/gt/gt.txt"),
              "1,1,1,1,3,2,1,1,1,-1\n1,2,1,1,3,2,1," + type + ",1,-1\n");
    EXPECT_EQ(read_file(root / "labels.txt"), asked ? "738\nc172\n" : "aircraft\n");
    EXPECT_EQ(read_file(root / "train/s/seqinfo.ini"),
              "[Sequence]\nname=s\nimDir=img1\nframeRate=30\nseqLength=1\nimWidth=0\nimHeight=0\n"
              "imExt=.jpg\n; exact frame rate: 29.97002997002997\n"
              "; visibility: unknown, written as 1\n");
    EXPECT_EQ(read_clips(Format::kMot, root, {}, {})[0].frames[0].labels[1], second);
  }
}

TEST_F(Origin, VocCountsPixelsFromOneAndTheLastBelongsToTheBox) {
  const std::string text = written(Format::kVoc, "Annotations/s_000000.xml");
  for (const char* part : {"<xmin>1</xmin>", "<ymin>1</ymin>", "<xmax>3</xmax>", "<ymax>2</ymax>"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

TEST_F(Origin, CvatEndsATrackWithABoxOutside) {
  const std::string text = written(Format::kCvat, "train/s/annotations.xml");
  EXPECT_NE(text.find("frame=\"0\" outside=\"0\""), std::string::npos);
  EXPECT_NE(text.find("frame=\"1\" outside=\"1\""), std::string::npos);
  EXPECT_NE(text.find("frame=\"2\" outside=\"0\""), std::string::npos);
  EXPECT_NE(text.find("xtl=\"0\" ytl=\"0\" xbr=\"3\" ybr=\"2\""), std::string::npos);
}

TEST_F(Origin, SingleObjectFolders) {
  EXPECT_EQ(written(Format::kOtb, "train/s/groundtruth_rect.txt"), "1,1,3,2\n0,0,0,0\n1,1,3,2\n");
  EXPECT_EQ(first_image_, "train/s/img/0001.jpg");
  EXPECT_EQ(written(Format::kGot10k, "train/s/absence.label"), "0\n1\n0\n");
  EXPECT_EQ(read_file(folder_.path() / "train/s/cover.label"), "4\n0\n4\n");
  EXPECT_EQ(first_image_, "train/s/00000001.jpg");
  EXPECT_EQ(written(Format::kVot, "train/s/groundtruth.txt"),
            "0,0,3,2\nnan,nan,nan,nan\n0,0,3,2\n");
  EXPECT_EQ(first_image_, "train/s/color/00000001.jpg");
  EXPECT_EQ(read_file(folder_.path() / "train/s/anchor.value"), "1\n0\n0\n");
}

TEST_F(Origin, ATableHasARowForEachBox) {
  EXPECT_EQ(written(Format::kTable, "frames.csv"),
            "part,sequence,frame,time_s,track,category,class,box_px_x,box_px_y,box_px_width,"
            "box_px_height,visible,occluded,truncated,range_m,above_horizon,contrast_to_noise,"
            "area_px\n"
            "train,s,0,0,1,738,aircraft,0,0,3,2,0.5,,,700,,,\n"
            "train,s,2,0.08,1,738,aircraft,0,0,3,2,0.5,,,700,,,\n");
}

TEST_F(Origin, AotHasAnEntityForAFrameThatShowsNothing) {
  const std::string text = written(Format::kAot, "train/ImageSets/groundtruth.json");
  EXPECT_NE(text.find(R"("time":1500000000040000000,"blob":{"frame":1},"flight_id":"s",)"
                      R"("img_name":"1500000000040000000s.png","labels":{}})"),
            std::string::npos)
      << text;
  EXPECT_EQ(first_image_, "train/Images/s/1500000000000000000s.png");
  // 3 frames at 25 Hz.
  EXPECT_NE(text.find(R"("fps":25.0,"number_of_frames":3,"duration":120.0)"), std::string::npos);
  EXPECT_NE(text.find(R"("id":"Airplane1","bb":[0.0,0.0,3.0,2.0])"), std::string::npos);
  EXPECT_NE(text.find(R"("range_distance_m":700.0)"), std::string::npos);
}

// One frame with an aircraft, a bird and dirt.
Clip clip_with_distractors() {
  Clip clip;
  clip.name = "sky";
  clip.width = 640;
  clip.height = 480;
  clip.frame_rate_hz = 30;
  Label aircraft{.track = 1, .category = "c172", .box_px = {10, 20, 30, 40}};
  Label bird{.track = 2, .category = "bird", .box_px = {100, 20, 8, 4}};
  bird.object_class = "bird";
  Label dirt{.track = 3, .category = "dirt", .box_px = {200, 200, 60, 60}};
  dirt.object_class = "dirt";
  clip.frames = {{0, 0.0, {aircraft, bird, dirt}}, {1, 1.0 / 30, {aircraft, bird, dirt}}};
  return clip;
}

std::size_t times_in(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++count;
  return count;
}

// Keys end at the first dot of a name, and a shard with the sample that fills it.
TEST(Webdataset, HasSamplesInShards) {
  const Folder folder;
  Clip clip;
  clip.name = "a.b%";
  for (std::int64_t i = 0; i < 5; ++i) clip.frames.push_back({i, {}, {}});
  WriteOptions options;
  options.shard_bytes =
      6 * 512;  // a sample is of 5 blocks: two headers, and one and two of content
  const auto writer = make_writer(Format::kWebdataset, folder.path(), options);
  const std::vector<fs::path> pictures = writer->images(clip, "train");
  for (const fs::path& picture : pictures) folder.file(picture.string(), std::string(513, 'p'));
  writer->add(clip, "train");
  writer->finish();
  std::vector<std::string> names;
  for (int shard = 0; shard < 3; ++shard)
    tar::each_file(folder.path() / ("train-00000" + std::to_string(shard) + ".tar"),
                   "",
                   [&](const std::string& name, const std::string& bytes) {
                     names.push_back(std::to_string(shard) + " " + name);
                     EXPECT_EQ(bytes.size() == 513, name.ends_with(".jpg"));
                   });
  EXPECT_EQ(names.size(), 10u);
  EXPECT_EQ(names.at(0), "0 a%2Eb%25_000000.jpg");
  EXPECT_EQ(names.at(1), "0 a%2Eb%25_000000.json");
  EXPECT_EQ(names.at(9), "2 a%2Eb%25_000004.json");
}

TEST(Webdataset, KeepsClassesThatNoCategoryStates) {
  const Folder folder;
  Clip clip;
  clip.name = "a";
  for (const char* object_class : {"ignore", "bird", "aircraft"}) {
    Label label;
    label.category = "aircraft";
    label.object_class = object_class;
    label.box_px = {1, 2, 3, 4};
    clip.frames.push_back({std::ssize(clip.frames), {}, {label}});
  }
  WriteOptions options;
  options.with_images = false;
  const auto writer = make_writer(Format::kWebdataset, folder.path(), options);
  writer->add(clip, "train");
  writer->finish();
  EXPECT_EQ(read_clips(Format::kWebdataset, folder.path(), {}, {}).at(0).frames, clip.frames);
  ReadOptions all_birds;
  all_birds.class_of["aircraft"] = "bird";
  const Clip birds = read_clips(Format::kWebdataset, folder.path(), all_birds, {}).at(0);
  EXPECT_EQ(birds.frames.at(0).labels.at(0).object_class, "ignore");
  for (const std::size_t i : {1u, 2u})
    EXPECT_EQ(birds.frames.at(i).labels.at(0).object_class, "bird");
}

TEST(Webdataset, WhatIsNoSampleIsNamed) {
  const auto refused = [](const std::string& json, const char* words) {
    const Folder folder;
    tar::Writer archive(folder.path() / "a.tar");
    archive.add("x.json", json);
    archive.finish();
    EXPECT_THAT(error_of(Format::kWebdataset, folder.path()), testing::HasSubstr(words));
  };
  refused("{}", "a.tar/x.json: has no clip");
  refused(R"({"clip": "a", "frame": -1, "labels": []})", "frame is -1");
  refused(R"({"clip": "a", "frame": 0, "labels": [{"track": 1}]})", "labels[0] has no category");
  refused("[", "x.json");
  const Folder none;
  EXPECT_THAT(error_of(Format::kWebdataset, none.path()), testing::HasSubstr("holds no sample"));
  EXPECT_THAT(error_of(Format::kTable, none.path()), testing::HasSubstr("written alone"));
}

TEST(Distractors, AreNoTrackingTargets) {
  for (const Format format : {Format::kOtb, Format::kGot10k, Format::kVot}) {
    const std::vector<Clip> clips = arranged(format, clip_with_distractors());
    ASSERT_EQ(clips.size(), 1U);
    EXPECT_EQ(clips[0].name, "sky");
    EXPECT_EQ(clips[0].frames[0].labels[0].category, "c172");
  }
  Clip birds = aircraft_alone(clip_with_distractors());
  EXPECT_EQ(birds.frames[0].labels.size(), 1U);
  for (LabelledFrame& frame : birds.frames) frame.labels.clear();
  EXPECT_TRUE(arranged(Format::kOtb, birds).empty());
  EXPECT_EQ(arranged(Format::kCoco, clip_with_distractors())[0].frames[0].labels.size(), 3U);
}

TEST(Distractors, HaveTheirPlaceInEachFormat) {
  const Folder folder;
  const Part part{"train", {clip_with_distractors()}};
  write_clips(Format::kCoco, folder.path() / "coco", {&part, 1});
  const auto again = read_clips(Format::kCoco, folder.path() / "coco", {}, {});
  std::vector<std::string> categories;
  for (const Label& label : again[0].frames[0].labels) categories.push_back(label.category);
  std::sort(categories.begin(), categories.end());
  EXPECT_EQ(categories, (std::vector<std::string>{"bird", "c172", "dirt"}));

  write_clips(Format::kMot, folder.path() / "mot", {&part, 1});
  const std::string truth = read_file(folder.path() / "mot" / "train" / "sky" / "gt" / "gt.txt");
  // frame, id, box, to be considered, class
  EXPECT_NE(truth.find("1,1,11,21,30,40,1,1,"), std::string::npos) << truth;
  EXPECT_NE(truth.find("1,2,101,21,8,4,0,1,"), std::string::npos) << truth;
  EXPECT_NE(truth.find("1,3,201,201,60,60,0,1,"), std::string::npos) << truth;

  write_clips(Format::kAot, folder.path() / "aot", {&part, 1});
  const std::string flights =
      read_file(folder.path() / "aot" / "train" / "ImageSets" / "groundtruth.json");
  EXPECT_EQ(times_in(flights, "\"Airplane1\""), 2U);
  EXPECT_EQ(times_in(flights, "\"Bird2\""), 2U);
  EXPECT_EQ(times_in(flights, "dirt"), 0U);
}

}  // namespace
}  // namespace airtruth::exchange
