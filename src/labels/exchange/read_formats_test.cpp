// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "labels/exchange/exchange.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/text.h"
#include "support/exchange_formats.h"

namespace airtruth::exchange {
namespace {

// The library for tracker authors decodes no pictures; a caller may state how to read their size.
TEST(Yolo, TheSizeOfPicturesComesFromTheCaller) {
  const Folder folder;
  folder.file("labels/s_000000.txt", "0 0.5 0.5 0.25 0.5\n");
  folder.file("images/s_000000.jpg", "no picture");
  EXPECT_THROW(read_clips(Format::kYolo, folder.path(), {}, {}), Error);
  ReadOptions options;
  options.size_of_picture = [](const fs::path& file) {
    EXPECT_EQ(file.filename(), "s_000000.jpg");
    return std::pair(64, 48);
  };
  const auto clips = read_clips(Format::kYolo, folder.path(), options, {});
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].frames.at(0).labels.at(0).box_px, (Box{24, 12, 16, 24}));
}

// Labels of our own hold no such rate: a clip with it could be read, and not written and read
// again.
TEST(FrameRates, BeyondEveryCameraCountAsUnknown) {
  for (const char* rate : {"1.1e19", "-25", "0"}) {
    const Folder folder;
    folder.file("coco.json",
                fmt::format(R"({{"videos":[{{"id":1,"name":"a","frame_rate_hz":{}}}],)"
                            R"("images":[{{"id":1,"file_name":"a/1.png","video_id":1,"width":9,)"
                            R"("height":9}}],"annotations":[],"categories":[]}})",
                            rate));
    folder.file("aot.json",
                fmt::format(R"({{"samples":{{"f":{{"metadata":{{"fps":{},"number_of_frames":1}},)"
                            R"("entities":[]}}}}}})",
                            rate));
    folder.file("mot/train/a/seqinfo.ini",
                fmt::format("frameRate={0}\nseqLength=1\n; exact frame rate: {0}\n", rate));
    folder.file("mot/train/a/gt/gt.txt", "1,1,1,1,3,3,1,1,1\n");
    folder.file("vot/a/sequence", fmt::format("fps={0}\nexact_fps={0}\nwidth=9\nheight=9\n", rate));
    folder.file("vot/a/groundtruth.txt", "1,1,3,3\n");
    folder.file("got/a/meta_info.ini", fmt::format("anno_fps: {}Hz\nresolution: (9, 9)\n", rate));
    folder.file("got/a/groundtruth.txt", "1,1,3,3\n");
    const auto expect_unknown = [&](Format format, const char* place) {
      const auto clips = read_clips(format, folder.path() / place, {}, {});
      ASSERT_EQ(clips.size(), 1u) << place;
      EXPECT_EQ(clips[0].frame_rate_hz, std::nullopt) << place << " " << rate;
    };
    expect_unknown(Format::kCoco, "coco.json");
    expect_unknown(Format::kAot, "aot.json");
    expect_unknown(Format::kMot, "mot");
    expect_unknown(Format::kVot, "vot");
    expect_unknown(Format::kGot10k, "got");
  }
}

TEST(Coco, OfOthersMayHaveGapsPolygonsAndBoxesOutside) {
  const Folder folder;
  const fs::path file = folder.file("foreign.json", R"({
    "categories": [{"id": 7, "name": "plane"}],
    "images": [{"id": 900, "file_name": "x/3.jpg", "width": 100, "height": 50},
               {"id": 12, "file_name": "x/1.jpg", "width": 100, "height": 50}],
    "annotations": [
      {"id": 5, "image_id": 900, "category_id": 7, "segmentation": [[10, 5, 30, 5, 30, 20]]},
      {"id": 88, "image_id": 900, "category_id": 7, "bbox": [200, 5, 10, 10]},
      {"id": 89, "image_id": 900, "category_id": 7, "bbox": [1, 1, 0, 10]},
      {"id": 90, "image_id": 4, "category_id": 7, "bbox": [1, 1, 2, 2]},
      {"id": 91, "image_id": 12, "category_id": 7, "segmentation": {"counts": "abc", "size": [50, 100]}}
    ]})");
  std::vector<std::string> warnings;
  const auto clips =
      read_clips(Format::kCoco, file, {}, [&](const std::string& w) { warnings.push_back(w); });
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].name, "x");
  ASSERT_EQ(clips[0].frames.size(), 2u);
  // The order is that of the pictures' numbers.
  EXPECT_TRUE(clips[0].frames[0].labels.empty());
  ASSERT_EQ(clips[0].frames[1].labels.size(), 1u);
  EXPECT_EQ(clips[0].frames[1].labels[0].box_px, (Box{10, 5, 20, 15}));
  std::string all;
  for (const std::string& warning : warnings) all += warning + "\n";
  EXPECT_NE(all.find("2 boxes that are empty or outside their image (the first: annotations[1])"),
            std::string::npos)
      << all;
  EXPECT_NE(all.find("1 annotations of images that are not listed"), std::string::npos) << all;
  EXPECT_NE(all.find("1 annotations with neither bbox nor polygons"), std::string::npos) << all;
}

// ffmpeg, MOTChallenge and the converters of trackers begin with 1; frames begin with 0.
TEST(Coco, NumbersThatBeginWithOneCountFromIt) {
  const Folder folder;
  const auto frames_of = [&](const std::string& first, const std::string& second) {
    const fs::path file =
        folder.file("a.json",
                    R"({"categories": [], "annotations": [], "images": [
      {"id": 1, "width": 64, "height": 48, )" +
                        first + R"(}, {"id": 2, "width": 64, "height": 48, )" + second + "}]}");
    const auto clips = read_clips(Format::kCoco, file, {}, {});
    return std::pair(clips.at(0).frames.at(0).frame, clips[0].frames.at(1).frame);
  };
  using Pair = std::pair<std::int64_t, std::int64_t>;
  const std::string seventh = R"("file_name": "a_000007.jpg")";
  EXPECT_EQ(frames_of(R"("file_name": "a_000001.jpg")", seventh), Pair(0, 6));
  EXPECT_EQ(frames_of(R"("file_name": "a_000000.jpg")", seventh), Pair(0, 7));
  EXPECT_EQ(frames_of(R"("file_name": "a_000003.jpg")", seventh), Pair(3, 7));
  EXPECT_EQ(
      frames_of(R"("file_name": "a_000003.jpg", "frame_id": 1)", seventh + R"(, "frame_id": 5)"),
      Pair(0, 4));
}

TEST(Coco, CrowdsCountNeitherWayAndPicturesOfSeveralSizesAreNoVideo) {
  const Folder folder;
  const fs::path file = folder.file("instances_val2017.json", R"({
    "categories": [{"id": 5, "name": "airplane"}],
    "images": [{"id": 139, "file_name": "000000000139.jpg", "width": 640, "height": 426},
               {"id": 581929, "file_name": "000000581929.jpg", "width": 500, "height": 375}],
    "annotations": [
      {"id": 1, "image_id": 139, "category_id": 5, "bbox": [1, 2, 3, 4], "iscrowd": 0},
      {"id": 2, "image_id": 139, "category_id": 5, "bbox": [5, 5, 90, 80], "iscrowd": 1,
       "segmentation": {"counts": [0, 9], "size": [426, 640]}}]})");
  std::string warnings;
  const auto clips =
      read_clips(Format::kCoco, file, {}, [&](const std::string& w) { warnings += w + "\n"; });
  ASSERT_EQ(clips.size(), 1u);
  ASSERT_EQ(clips[0].frames.size(), 2u);
  EXPECT_EQ(clips[0].frames[1].frame, 581929);
  EXPECT_EQ(clips[0].width, 0);
  ASSERT_EQ(clips[0].frames[0].labels.size(), 2u);
  EXPECT_EQ(clips[0].frames[0].labels[0].box_px, (Box{1, 2, 3, 4}));
  EXPECT_EQ(clips[0].frames[0].labels[0].object_class, "aircraft");
  EXPECT_EQ(clips[0].frames[0].labels[1].box_px, (Box{5, 5, 90, 80}));
  EXPECT_EQ(clips[0].frames[0].labels[1].object_class, "ignore");
  EXPECT_EQ(warnings.find("left out"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("differ in size"), std::string::npos) << warnings;
}

TEST(Coco, ASetOfCrowdsAloneIsSaid) {
  const Folder folder;
  const auto warnings_of = [&](const std::string& second) {
    const fs::path file = folder.file("crowds.json",
                                      R"({
      "categories": [{"id": 5, "name": "aircraft"}],
      "images": [{"id": 1, "file_name": "1.png", "width": 64, "height": 48}],
      "annotations": [
        {"id": 1, "image_id": 1, "category_id": 5, "bbox": [1, 2, 3, 4], "iscrowd": 1},
        {"id": 2, "image_id": 1, "category_id": 5, "bbox": [5, 5, 9, 8], "iscrowd": )" +
                                          second + "}]}");
    std::string warnings;
    read_clips(Format::kCoco, file, {}, [&](const std::string& w) { warnings += w + "\n"; });
    return warnings;
  };
  EXPECT_NE(warnings_of("1").find("all 2 boxes are marked as counting neither way"),
            std::string::npos);
  EXPECT_EQ(warnings_of("0").find("neither way"), std::string::npos);
}

TEST(Coco, CountedTracksAreNoneOfThoseThatAreStated) {
  const Folder folder;
  const auto file = [&](const std::string& second) {
    return folder.file("tracks.json",
                       R"({"categories": [{"id": 1, "name": "plane"}, {"id": 2, "name": "ignored"}],
      "images": [{"id": 9, "file_name": "1.png", "width": 64, "height": 48}],
      "annotations": [
        {"id": 1, "image_id": 9, "category_id": 1, "bbox": [1, 2, 3, 4]},
        {"id": 2, "image_id": 9, "category_id": 1, "bbox": [1, 2, 3, 4], "track_id": 1},
        {"id": 3, "image_id": 9, "category_id": 1, "bbox": [1, 2, 3, 4], "track_id": -1},
        {"id": 4, "image_id": 9, "category_id": 2, "bbox": [1, 2, 3, 4], "track_id": 1},
        {"id": 5, "image_id": 9, "category_id": 1, "bbox": [1, 2, 3, 4], "instance_id": )" +
                           second + "}]}");
  };
  std::string warnings;
  const auto clips =
      read_clips(Format::kCoco, file("3"), {}, [&](const std::string& w) { warnings += w + "\n"; });
  std::vector<std::int64_t> tracks;
  for (const Label& label : clips.at(0).frames.at(0).labels) tracks.push_back(label.track);
  EXPECT_EQ(tracks, (std::vector<std::int64_t>{2, 1, 4, 1, 3}));
  EXPECT_NE(warnings.find("tracks.json: holds boxes without a track"), std::string::npos)
      << warnings;
  const std::string error = error_of(Format::kCoco, file("1"));
  EXPECT_TRUE(error.ends_with("annotations[4]: has the track 1 a second time in image 9")) << error;
}

TEST(Coco, ASupercategoryStatesTheClassThatTheNameDoesNot) {
  const Folder folder;
  const fs::path file = folder.file("sky.json", R"({
    "categories": [{"id": 1, "name": "gull", "supercategory": "bird"},
                   {"id": 2, "name": "738", "supercategory": "aircraft"},
                   {"id": 3, "name": "drone", "supercategory": "bird"},
                   {"id": 4, "name": "thing", "supercategory": "none"}],
    "images": [{"id": 1, "file_name": "1.png", "width": 64, "height": 48}],
    "annotations": [{"id": 1, "image_id": 1, "category_id": 1, "bbox": [1, 2, 3, 4], "track_id": 1},
                    {"id": 2, "image_id": 1, "category_id": 2, "bbox": [1, 2, 3, 4], "track_id": 2},
                    {"id": 3, "image_id": 1, "category_id": 3, "bbox": [1, 2, 3, 4], "track_id": 3},
                    {"id": 4, "image_id": 1, "category_id": 4, "bbox": [1, 2, 3, 4], "track_id": 4}
                   ]})");
  std::string warnings;
  const auto clips =
      read_clips(Format::kCoco, file, {}, [&](const std::string& w) { warnings += w + "\n"; });
  std::vector<std::string> classes;
  for (const Label& label : clips.at(0).frames.at(0).labels) classes.push_back(label.object_class);
  EXPECT_EQ(classes, (std::vector<std::string>{"bird", "aircraft", "multirotor", "aircraft"}));
  EXPECT_NE(warnings.find("1 categories state no class and count as aircraft: 'thing' (1)"),
            std::string::npos)
      << warnings;
  // What the user says goes before the set's own word.
  ReadOptions options;
  options.class_of["gull"] = "balloon";
  EXPECT_EQ(
      read_clips(Format::kCoco, file, options, {}).at(0).frames.at(0).labels.at(0).object_class,
      "balloon");
}

TEST(Voc, WhatIsDifficultCountsNeitherWay) {
  const Folder folder;
  folder.file("Annotations/a_1.xml",
              "<annotation><size><width>64</width><height>48</height></size>"
              "<object><name>aeroplane</name><difficult>1</difficult><bndbox><xmin>1</xmin>"
              "<ymin>1</ymin><xmax>9</xmax><ymax>9</ymax></bndbox></object>"
              "<object><name>aeroplane</name><difficult>0</difficult><bndbox><xmin>11</xmin>"
              "<ymin>1</ymin><xmax>19</xmax><ymax>9</ymax></bndbox></object></annotation>");
  const auto labels = read_clips(Format::kVoc, folder.path(), {}, {}).at(0).frames.at(0).labels;
  ASSERT_EQ(labels.size(), 2u);
  EXPECT_EQ(labels[0].object_class, "ignore");
  EXPECT_EQ(labels[1].object_class, "aircraft");
}

// The truth of MOT17 and MOT20 has lines that are not to be considered for what is no pedestrian.
// Some sets give all such regions of a frame the same id.
TEST(Mot, LinesThatAreNotToBeConsideredCountNeitherWay) {
  const Folder folder;
  folder.file("a/gt/gt.txt",
              "1,1,5,5,9,9,1,1,1\n1,0,15,5,9,9,0,7,1\n1,0,25,5,9,9,0,7,1\n2,1,5,5,9,9,0,1,1\n");
  std::string warnings;
  const auto clips = read_clips(
      Format::kMot, folder.path(), {}, [&](const std::string& w) { warnings += w + "\n"; });
  std::vector<std::string> classes;
  for (const LabelledFrame& frame : clips.at(0).frames)
    for (const Label& label : frame.labels) classes.push_back(label.object_class);
  EXPECT_EQ(classes, (std::vector<std::string>{"aircraft", "ignore", "ignore", "ignore"}));
  EXPECT_EQ(warnings.find("left out"), std::string::npos) << warnings;
}

// The id -1 is that of no track: two such boxes of a frame are two aircraft.
TEST(Mot, BoxesWithoutATrackAreObjectsOfTheirOwn) {
  const Folder folder;
  folder.file("a/gt/gt.txt",
              "1,-1,5,5,9,9,1,1,1\n1,1,15,5,9,9,1,1,1\n1,-1,25,5,9,9,1,1,1\n2,-1,5,5,9,9,1,1,1\n");
  std::string warnings;
  const auto clips = read_clips(
      Format::kMot, folder.path(), {}, [&](const std::string& w) { warnings += w + "\n"; });
  std::vector<std::int64_t> tracks;
  for (const LabelledFrame& frame : clips.at(0).frames)
    for (const Label& label : frame.labels) tracks.push_back(label.track);
  EXPECT_EQ(tracks, (std::vector<std::int64_t>{2, 1, 3, 1}));
  EXPECT_NE(warnings.find("gt.txt: holds boxes without a track"), std::string::npos) << warnings;
}

// An entity of the published training set, as docs/DATASET.md prints it, with the NaN that Python
// writes. Times count from 1970.
TEST(Aot, ThePublishedFilesHoldNanAndTimesSince1970) {
  const Folder folder;
  const fs::path file = folder.file("part1/ImageSets/groundtruth.json", R"({"metadata": {},
    "samples": {"280dc81adbb3420cab502fb88d6abf84": {
      "metadata": {"data_path": "train3/2/", "fps": 10.0, "number_of_frames": 3, "duration": 300.0,
                   "resolution": {"height": 2048, "width": 2448}},
      "entities": [
        {"time": 1550844897819368155, "blob": {"frame": 0, "range_distance_m": NaN},
         "id": "Bird2", "bb": [1013.4, 515.8, 6.0, 6.0], "labels": {"is_above_horizon": 1},
         "flight_id": "280dc81adbb3420cab502fb88d6abf84", "img_name": "a NaN \" NaN.png"},
        {"time": 1550844897919368155, "blob": {"frame": 1, "range_distance_m": -Infinity}, "id": "Airplane1",
         "bb": [1, 2, 3, 4], "labels": {"is_above_horizon": -1}, "flight_id": "x", "img_name": "b"},
        {"time": 1550844898019368156, "blob": {"frame": 2, "range_distance_m": nan},
         "labels": {}, "flight_id": "x", "img_name": "c"}]}}})");
  const auto clips = read_clips(Format::kAot, file, {}, {});
  ASSERT_EQ(clips.size(), 1u);
  ASSERT_EQ(clips[0].frames.size(), 3u);
  ASSERT_EQ(clips[0].frames[0].labels.size(), 1u);
  const Label& bird = clips[0].frames[0].labels[0];
  EXPECT_EQ(bird.category, "Bird");
  EXPECT_EQ(bird.range_m, std::nullopt);
  EXPECT_EQ(bird.above_horizon, true);
  EXPECT_EQ(bird.box_px, (Box{1013.4, 515.8, 6, 6}));
  EXPECT_EQ(clips[0].frames[1].labels[0].range_m, std::nullopt);
  EXPECT_EQ(clips[0].frames[0].time_s, 0.0);
  EXPECT_EQ(clips[0].frames[1].time_s, 0.1);
  EXPECT_EQ(clips[0].frames[2].time_s, 0.200000001);
}

// VOT's own words for regions (vot/region/io.py). The masks are worked by hand:
// a window 4 x 3 at (10, 20) of the rows 0110 / 0111 / 0000; one whose ones run over the row's end.
TEST(Vot, MasksPolygonsAndSpecialRegions) {
  const Folder folder;
  folder.file("s/groundtruth.txt",
              "m10,20,4,3,1,2,2,3,4\n"
              "m-2,5,4,2,3,2,3\n"
              "m0,0,0,0,0\n"
              "1\n"
              "nan,nan,nan,nan\n"
              "1,2,5,2,5,8,1,8\n"
              "1.5,2,3,4\n");
  const auto clips = read_clips(Format::kVot, folder.path(), {}, {});
  ASSERT_EQ(clips.size(), 1u);
  const auto& frames = clips[0].frames;
  ASSERT_EQ(frames.size(), 7u);
  EXPECT_EQ(frames[0].labels.at(0).box_px, (Box{11, 20, 3, 2}));
  EXPECT_EQ(frames[1].labels.at(0).box_px, (Box{-2, 5, 4, 2}));
  for (const std::size_t i : {2u, 3u, 4u}) EXPECT_TRUE(frames[i].labels.empty()) << i;
  EXPECT_EQ(frames[5].labels.at(0).box_px, (Box{1, 2, 4, 6}));
  EXPECT_EQ(frames[6].labels.at(0).box_px, (Box{1.5, 2, 3, 4}));
}

// LabelImg (libs/yolo_io.py) writes the names of the classes into the labels' folder.
TEST(Yolo, TheNamesOfTheClassesMayLieAmongTheLabels) {
  for (const char* place : {"labels/classes.txt", "labels/train/classes.txt"}) {
    const Folder folder;
    folder.file(place, "bird\nairplane\n");
    folder.file("labels/train/s_000000.txt", "1 0.5 0.5 0.2 0.4\n");
    const auto clips = read_clips(Format::kYolo, folder.path(), {{{100, 50}}, "aircraft"}, {});
    ASSERT_EQ(clips.size(), 1u) << place;
    ASSERT_EQ(clips[0].frames.size(), 1u) << place;
    EXPECT_EQ(clips[0].frames[0].labels.at(0).category, "airplane") << place;
  }
}

// Without kpt_shape the first line is a polygon over the whole of its points.
TEST(Yolo, KeyPointsStandBehindTheBox) {
  const Folder folder;
  folder.file("data.yaml", "kpt_shape: [2, 2]\nnames: [airplane]\n");
  folder.file("labels/s_000000.txt",
              "0 0.5 0.5 0.25 0.5 0.45 0.5 0.55 0.5\n0 0.5 0.5 0.25 0.5 0 0 0 0 0.9\n"
              "0 0.5 0.5 0.25 0.5\n");
  const ReadOptions options{{{64, 48}}, "aircraft"};
  const auto clips = read_clips(Format::kYolo, folder.path(), options, {});
  ASSERT_EQ(clips.at(0).frames.at(0).labels.size(), 3u);
  for (const Label& label : clips[0].frames[0].labels)
    EXPECT_EQ(label.box_px, (Box{24, 12, 16, 24}));
  folder.file("labels/s_000000.txt", "0 0.5 0.5 0.25 0.5 0.45 0.5\n");
  const std::string error =
      test_support::error_of([&] { read_clips(Format::kYolo, folder.path(), options, {}); });
  EXPECT_TRUE(error.find("s_000000.txt:1: has 7 numbers; expected") != std::string::npos) << error;
}

// A visibility of 2 is no share of a picture. The first line is a polygon that touches two sides.
TEST(Yolo, KeyPointsThatNothingStatesAreRefused) {
  const Folder folder;
  folder.file("labels/s_000000.txt",
              "0 0.5 0.5 0.25 0.5 0.45 0.5 1 0.55 0.5 0\n0 0.5 0.5 0.25 0.5 0.4 0.5 2 0.5 0.5 0\n");
  const std::string error = test_support::error_of([&] {
    read_clips(Format::kYolo, folder.path(), {{{64, 48}}, "aircraft"}, {});
  });
  EXPECT_TRUE(error.find("s_000000.txt:2: has 2 key points") != std::string::npos) << error;
  EXPECT_TRUE(error.find("expected kpt_shape: [2, 3]") != std::string::npos) << error;
}

TEST(Yolo, PolygonsCountByTheirBounds) {
  const Folder folder;
  folder.file("labels/train/s_000000.txt", "0 0.1 0.2 0.3 0.2 0.3 0.6\n1 0.5 0.5 0.2 0.4 0.9\n");
  const auto clips = read_clips(Format::kYolo, folder.path(), {{{100, 50}}, "aircraft"}, {});
  ASSERT_EQ(clips.at(0).frames.at(0).labels.size(), 2u);
  const Box polygon = clips[0].frames[0].labels[0].box_px;
  EXPECT_NEAR(polygon.x, 10, 1e-9);
  EXPECT_NEAR(polygon.y, 10, 1e-9);
  EXPECT_NEAR(polygon.width, 20, 1e-9);
  EXPECT_NEAR(polygon.height, 20, 1e-9);
  // A sixth number is the confidence of a detector.
  EXPECT_NEAR(clips[0].frames[0].labels[1].box_px.width, 20, 1e-9);
}

TEST(Cvat, ForImagesHasItsBoxesInThePictures) {
  const Folder folder;
  const fs::path file =
      folder.file("task/annotations.xml", R"(<?xml version="1.0" encoding="utf-8"?>
<annotations><version>1.1</version>
  <meta><task><name>t</name><size>2</size></task></meta>
  <image id="0" name="a_01.jpg" width="64" height="48"></image>
  <image id="1" name="a_02.jpg" width="64" height="48">
    <box label="plane" source="manual" occluded="1" xtl="3.5" ytl="4" xbr="13.5" ybr="9" z_order="0">
      <attribute name="range_m">700</attribute></box>
    <box label="bird" occluded="0" xtl="30" ytl="4" xbr="32" ybr="9"/>
    <box label="bird" occluded="0" xtl="40" ytl="4" xbr="42" ybr="9">
      <attribute name="track_id">2</attribute></box></image>
</annotations>)");
  const auto clips = read_clips(Format::kCvat, file, {}, {});
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].width, 64);
  ASSERT_EQ(clips[0].frames.size(), 2u);
  EXPECT_TRUE(clips[0].frames[0].labels.empty());
  ASSERT_EQ(clips[0].frames[1].labels.size(), 3u);
  const Label& plane = clips[0].frames[1].labels[0];
  EXPECT_EQ(plane.box_px, (Box{3.5, 4, 10, 5}));
  EXPECT_EQ(plane.category, "plane");
  EXPECT_EQ(plane.occluded, true);
  EXPECT_EQ(plane.range_m, 700);
  // A counted track is none that the picture states.
  EXPECT_EQ(plane.track, 1);
  EXPECT_EQ(clips[0].frames[1].labels[1].track, 3);
  EXPECT_EQ(clips[0].frames[1].labels[2].track, 2);
}

// Boxes of frames before start_frame count within the task, and so must the pictures.
TEST(Cvat, APictureOfNoFrameIsNamed) {
  const Folder folder;
  folder.file("images/a.png", "no picture");
  const std::string error = error_of(Format::kCvat, folder.file("annotations.xml", R"(<annotations>
<meta><task><size>2</size><start_frame>100</start_frame></task></meta>
<image id="100" name="a.png"/>
<track id="0" label="plane"><box frame="0" xtl="1" ytl="1" xbr="5" ybr="5"/></track>
</annotations>)"));
  EXPECT_TRUE(
      error.ends_with("annotations.xml:3: <image> has the id 100, and the boxes' frames "
                      "count from 0; expected an id below 2"))
      << error;
}

TEST(Format, IsKnownByNameAndNearMissesAreHelped) {
  for (const Format format : kWritten) EXPECT_EQ(format_from_name(name(format)), format);
  try {
    format_from_name("cocoo");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "unknown format 'cocoo'; did you mean 'coco'?");
  }
}

TEST(Published, EvisionIsReadWithItsEmptyFrames) {
  const Folder folder;
  const fs::path file = folder.file("1LRB737.xml", R"(<?xml version="1.0"?>
<opencv_storage>
<frame_1><CameraPos_m><x>0.</x><y>0.</y><z>-150.</z></CameraPos_m>
  <IntruderPos_m><x>700.</x><y>-900.</y><z>-350.</z></IntruderPos_m>
  <Distance_m>1150.</Distance_m>
  <IntruderRect_pix><x>11</x><y>340</y><width>30</width><height>9</height></IntruderRect_pix></frame_1>
<frame_3><CameraPos_m><x>0.</x><y>0.</y><z>-150.</z></CameraPos_m>
  <IntruderPos_m><x>700.</x><y>-900.</y><z>-350.</z></IntruderPos_m>
  <Distance_m>1150.</Distance_m>
  <IntruderRect_pix><x>0</x><y>0</y><width>0</width><height>0</height></IntruderRect_pix></frame_3>
</opencv_storage>)");
  const auto clips = read_clips(Format::kEvision, file, {}, {});
  ASSERT_EQ(clips.size(), 1u);
  ASSERT_EQ(clips[0].frames.size(), 3u);
  ASSERT_EQ(clips[0].frames[0].labels.size(), 1u);
  EXPECT_EQ(clips[0].frames[0].labels[0].box_px, (Box{11, 340, 30, 9}));
  EXPECT_EQ(clips[0].frames[0].labels[0].category, "B737");
  EXPECT_TRUE(clips[0].frames[1].labels.empty());
  EXPECT_TRUE(clips[0].frames[2].labels.empty());
}

TEST(Yolo, NamesAreAListOrAMapOfYaml) {
  const Folder folder;
  folder.file("labels/s_000000.txt", "1 0.5 0.5 0.25 0.5\n");
  ReadOptions options;
  options.size = {64, 48};
  for (const char* names : {"names: [bird, 'light aircraft']  # two\n",
                            "names:\n- bird\n- \"light aircraft\"\nnc: 2\n",
                            "names:\n  1: light aircraft\n  0: bird\n"}) {
    folder.file("data.yaml", names);
    const auto clips = read_clips(Format::kYolo, folder.path(), options, {});
    EXPECT_EQ(clips.at(0).frames.at(0).labels.at(0).category, "light aircraft") << names;
  }
  folder.file("data.yaml", "nc: 2\nnames: [bird\n");
  EXPECT_TRUE(error_of(Format::kYolo, folder.path()).find("data.yaml:") != std::string::npos);
}

TEST(Errors, NameTheFileAndThePlace) {
  const Folder folder;
  const auto ends = [&](const std::string& text, const std::string& end) {
    EXPECT_TRUE(text.ends_with(end)) << text;
  };
  ends(error_of(Format::kCoco, folder.file("a.json", "{\n\"images\": [}")),
       "a.json:2: is not JSON");
  ends(error_of(Format::kCoco, folder.file("b.json", R"({"categories": [{"id": 1}]})")),
       "b.json: categories[0] has no name; expected a string");
  folder.file("m/gt/gt.txt", "1,1,5,5,9,9\n0,1,5,5,9,9\n");
  ends(error_of(Format::kMot, folder.path() / "m"),
       "gt.txt:2: the frame is no whole number from 1 on");
  folder.file("m/gt/gt.txt", "1;1;10.5;20.5;30;40;1;1;1;5;7\n");
  ends(error_of(Format::kMot, folder.path() / "m"), "gt.txt:1: has 11 columns; expected 6 to 10");
  folder.file("o/groundtruth_rect.txt", "1,2,3,4\n1,2,x,4\n");
  ends(error_of(Format::kOtb, folder.path() / "o"),
       "groundtruth_rect.txt:2:5: 'x' is not a number");
  // A line is a frame, and the last one ends with a line end or several.
  folder.file("o/groundtruth_rect.txt", "1,2,3,4\n1,2,3,4\n\n1,2,3,4\n\n");
  ends(error_of(Format::kOtb, folder.path() / "o"),
       "groundtruth_rect.txt:3: is empty; expected the numbers of a frame, or nan");
  folder.file("o/groundtruth_rect.txt", "1,2,3,4\nnan\n1,2,3,4\n\n");
  ends(error_of(Format::kOtb, folder.path() / "o"), "no error");
  folder.file("mask/groundtruth.txt", "m0,0,4,2,3,6\n");
  ends(error_of(Format::kVot, folder.path() / "mask"),
       "groundtruth.txt:1: is no mask: its run lengths do not fit its window");
  ends(error_of(Format::kAot, folder.file("n.json", "{\"samples\": NaN}")),
       "n.json: samples is null; expected an object");
  ends(error_of(Format::kVoc, folder.file("v/p_1.xml", "<annotation>\n<size>")),
       "p_1.xml: holds no Annotations/*.xml");
  ends(error_of(Format::kCsv, folder.file("t.csv", "frame,x,y,w,h\n0,1,2,3\n")),
       "t.csv:2: has 4 columns; expected frame,x,y,w,h");
  // A cell that is empty would move those behind it.
  ends(error_of(Format::kCsv, folder.file("e.csv", "frame,score,x,y,w,h\n0,,1,2,3,4\n")),
       "e.csv:2:3: has an empty cell; expected a number");
  ends(error_of(Format::kCsv, folder.file("d.csv", "frame,id,x,y,w,h\n0,7,1,2,3,4\n0,7,5,6,7,8\n")),
       "d.csv:3: has the track 7 a second time in frame 0");
  ends(error_of(Format::kYolo, folder.path() / "nowhere"), "nowhere: does not exist");
}

// pandas writes what is unknown as an empty cell, and a German Excel 12.5 as "12,5" between
// semicolons.
TEST(Numbers, KeepTheirColumns) {
  const auto of = [](const std::string& text) {
    try {
      return fmt::format("{}", fmt::join(numbers_of({3, text}, "t"), " "));
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  for (const char* text : {"1,2.5,3", "1;2.5;3", "1 2.5\t3", " 1 , 2.5 ,3,"})
    EXPECT_EQ(of(text), "1 2.5 3") << text;
  EXPECT_EQ(of("1,,3"), "t:3:3: has an empty cell; expected a number");
  EXPECT_EQ(of("1; ;3"), "t:3:4: has an empty cell; expected a number");
  EXPECT_EQ(of(",2"), "t:3:1: has an empty cell; expected a number");
  EXPECT_EQ(of("12,5;33,25;10,5;8,75"),
            "t:3:3: has commas between semicolons; expected decimal points");
}

// "0,0,0,0" and "nan" state that there is no box; a box without width is left out with a warning.
TEST(ReadFormats, ACsvSaysWhatItLeavesOut) {
  const Folder folder;
  const fs::path file =
      folder.file("t.csv", "frame,x,y,w,h\n0,0,0,0,0\n1,nan,1,1,1\n2,5,5,0,9\n3,5,5,9,9\n");
  std::vector<std::string> warnings;
  const std::vector<Clip> clips = read_clips(
      Format::kCsv, file, {}, [&](const std::string& text) { warnings.push_back(text); });
  ASSERT_EQ(clips[0].frames.size(), 4u);
  EXPECT_TRUE(clips[0].frames[2].labels.empty());
  EXPECT_EQ(clips[0].frames[3].labels.size(), 1u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].substr(0, 20), "left out: 1 boxes th");
  EXPECT_TRUE(warnings[0].ends_with("t.csv:4)")) << warnings[0];
}

// The lines of a frame stand in any order; x is ten times the track.
TEST(ReadFormats, ACsvStatesItsTracksOrTheyAreCounted) {
  const Folder folder;
  std::string warnings;
  const auto tracks_of_file = [&](const std::string& text) {
    warnings.clear();
    const auto clips =
        read_clips(Format::kCsv, folder.file("t.csv", text), {}, [&](const std::string& warning) {
          warnings += warning + "\n";
        });
    std::vector<std::int64_t> tracks;
    for (const LabelledFrame& frame : clips.at(0).frames)
      for (const Label& label : frame.labels) tracks.push_back(label.track);
    return tracks;
  };
  using Tracks = std::vector<std::int64_t>;
  for (const char* column : {"id", "Track", "track_id", "object_id"}) {
    EXPECT_EQ(tracks_of_file(fmt::format("frame,{},x,y,w,h\n0,7,70,1,5,5\n0,3,30,1,5,5\n"
                                         "1,3,30,1,5,5\n1,7,70,1,5,5\n",
                                         column)),
              (Tracks{7, 3, 3, 7}));
    EXPECT_EQ(warnings, "");
  }
  EXPECT_EQ(tracks_of_file("0,70,1,5,5\n0,30,1,5,5\n1,30,1,5,5\n"), (Tracks{1, 2, 1}));
  EXPECT_NE(warnings.find("t.csv: holds boxes without a track"), std::string::npos) << warnings;
  EXPECT_EQ(tracks_of_file("0,70,1,5,5\n1,70,1,5,5\n"), (Tracks{1, 1}));
  EXPECT_EQ(warnings, "");
  // Such a number is that of the line.
  EXPECT_EQ(tracks_of_file("id,frame,x,y,w,h\n0,0,70,1,5,5\n1,1,70,1,5,5\n"), (Tracks{1, 1}));
  EXPECT_NE(warnings.find("t.csv: the column id numbers the boxes and no tracks"),
            std::string::npos)
      << warnings;
}

// A sequence of OTB with as many boxes as stated, box k at x = k, and pictures numbered from 1 (or
// from `first`).
void otb_sequence(
    const Folder& folder, const std::string& name, int boxes, int pictures, int first) {
  std::string text;
  for (int k = 0; k < boxes; ++k) text += fmt::format("{},1,3,4\n", k + 1);
  folder.file(name + "/groundtruth_rect.txt", text);
  for (int number = first; number < first + pictures; ++number)
    folder.file(fmt::format("{}/img/{:04}.jpg", name, number), "no picture");
}

// The toolkit's list (configSeqs.m): David's 471 boxes are of the pictures 300 to 770, the 74 of
// Football1 of the first ones; BlurCar1's pictures begin with 247.
TEST(Otb, BoxesBelongToThePicturesFromTheStartFrameOn) {
  const Folder folder;
  otb_sequence(folder, "David", 471, 770, 1);
  otb_sequence(folder, "Football1", 74, 362, 1);
  otb_sequence(folder, "BlurCar1", 742, 742, 247);
  otb_sequence(folder, "Tiger1", 354, 354, 1);
  std::map<std::string, std::pair<std::string, std::string>> ends;
  for (const Clip& clip : read_clips(Format::kOtb, folder.path(), {}, {}))
    ends[clip.name] = {clip.frames.front().picture, clip.frames.back().picture};
  EXPECT_EQ(ends["David"], std::pair(std::string("0300.jpg"), std::string("0770.jpg")));
  EXPECT_EQ(ends["Football1"], std::pair(std::string("0001.jpg"), std::string("0074.jpg")));
  EXPECT_EQ(ends["BlurCar1"], std::pair(std::string("0247.jpg"), std::string("0988.jpg")));
  EXPECT_EQ(ends["Tiger1"], std::pair(std::string("0001.jpg"), std::string("0354.jpg")));
}

TEST(Otb, AStartFrameThatIsNotKnownIsAskedFor) {
  const Folder folder;
  otb_sequence(folder, "mine", 3, 10, 1);
  EXPECT_TRUE(
      error_of(Format::kOtb, folder.path())
          .ends_with("mine: holds 10 pictures and 3 lines of boxes; state the number of the "
                     "first box's picture: --start-frame mine=N"));
  ReadOptions options;
  options.start_frames = {{"mine", 5}};
  const Clip clip = read_clips(Format::kOtb, folder.path(), options, {}).at(0);
  EXPECT_EQ(clip.frames.at(0).picture, "0005.jpg");
  EXPECT_EQ(clip.frames.at(2).picture, "0007.jpg");
  EXPECT_EQ(clip.frames.at(2).labels.at(0).box_px.x, 2);
  options.start_frames = {{"his", 5}};
  EXPECT_THROW(read_clips(Format::kOtb, folder.path(), options, {}), Error);
  options.start_frames = {{"mine", 5}};
  otb_sequence(folder, "others/mine", 3, 10, 1);
  EXPECT_THROW(read_clips(Format::kOtb, folder.path(), options, {}), Error);
}

// The two forms of the VisDrone toolkit (README of VisDrone2018-VID-toolkit and -DET-toolkit).
TEST(VisDrone, ItsColumnsAreNoneOfMotOrCsv) {
  const Folder folder;
  folder.file("v/gt/gt.txt", "1,0,593,43,174,190,0,0,0,0\n1,1,10,20,30,40,1,4,0,1\n");
  EXPECT_TRUE(error_of(Format::kMot, folder.path()).find("gt.txt:1: has VisDrone's columns") !=
              std::string::npos);
  // This program's own tenth column is a range in metres.
  folder.file("v/gt/gt.txt", "1,1,10,20,30,40,1,4,1,712.5\n2,1,10,20,30,40,1,4,0,1\n");
  EXPECT_EQ(error_of(Format::kMot, folder.path()), "no error");
  for (const char* line : {"684,8,273,116,1,4,0,0\n", "1,1,10,20,30,40,1,4,0,1\n"})
    EXPECT_TRUE(error_of(Format::kCsv, folder.file("d.txt", line)).find("which no header names") !=
                std::string::npos);
}

TEST(Pictures, OutsideOfTheirSetAreRefused) {
  const Folder folder;
  folder.file("secret.png", "x");
  const auto refused = [](const std::string& text) {
    return text.find("secret.png', which leads out of the set's folder") != std::string::npos;
  };
  const std::string absolute = (folder.path() / "secret.png").string();
  for (const std::string& name :
       {std::string("../../secret.png"), absolute, std::string("a/../../secret.png")}) {
    EXPECT_TRUE(refused(error_of(
        Format::kCoco,
        folder.file("c/annotations/instances_a.json",
                    R"({"categories": [], "annotations": [], "images": [{"id": 1, "file_name": ")" +
                        name + R"(", "width": 4, "height": 4}]})"))));
    EXPECT_TRUE(refused(error_of(
        Format::kCvat,
        folder.file("v/annotations.xml",
                    "<annotations><image id=\"0\" name=\"" + name + "\"/></annotations>"))));
    folder.file("o/Annotations/a.xml",
                "<annotation><filename>" + name + "</filename></annotation>");
    EXPECT_TRUE(refused(error_of(Format::kVoc, folder.path() / "o")));
    EXPECT_TRUE(refused(error_of(
        Format::kAot,
        folder.file("a/ImageSets/groundtruth.json",
                    R"({"samples": {"f": {"metadata": {}, "entities": [{"blob": {"frame": 0}, )"
                    R"("img_name": ")" +
                        name + R"("}]}}})"))));
  }
}

// An archive may hold pipes and links to devices.
TEST(Pictures, AndLabelsOfASetAreFiles) {
  const Folder folder;
  const auto expect_refused = [&](Format format, const char* set, const char* file) {
    const fs::path link = folder.path() / set / file;
    fs::create_directories(link.parent_path());
    fs::create_symlink("/dev/null", link);
    const std::string error = error_of(format, folder.path() / set);
    EXPECT_TRUE(error.ends_with(std::string(file) + ": is no regular file; expected one")) << error;
  };
  folder.file("y/labels/1.txt", "0 0.5 0.5 0.1 0.1\n");
  expect_refused(Format::kYolo, "y", "images/1.png");
  folder.file("d/labels/1.txt", "");
  expect_refused(Format::kYolo, "d", "data.yaml");
  expect_refused(Format::kMot, "m", "a/gt/gt.txt");
  folder.file("n/a/gt/gt.txt", "1,1,1,1,3,3\n");
  expect_refused(Format::kMot, "n", "a/seqinfo.ini");
  expect_refused(Format::kVot, "v", "a/groundtruth.txt");
}

// A set without parts: its pictures lie in images/ beside the annotations, or beside them.
TEST(Coco, PicturesOfASetWithoutPartsAreFound) {
  for (const std::string where : {"s/images/a/1.png", "s/a/1.png"}) {
    const Folder folder;
    folder.file(where, "x");
    // The pictures of another set beside it are not these.
    folder.file("images/a/1.png", "x");
    const Clip clip =
        read_clips(Format::kCoco,
                   folder.file("s/labels.json",
                               R"({"categories": [], "annotations": [], "images": [{"id": 1,
                               "file_name": "a/1.png", "width": 4, "height": 4}]})"),
                   {},
                   {})
            .at(0);
    EXPECT_EQ(clip.media / clip.frames.at(0).picture, folder.path() / where);
  }
}

TEST(Labels, NumbersOutOfRangeAreOneLine) {
  const Folder folder;
  const std::string head = R"({"format":"airtruth labels 1","name":"s"})";
  const auto error = [&](const std::string& text) {
    try {
      read_labels(folder.file("labels.jsonl", text));
    } catch (const Error& found) {
      return found.message() + " at " + std::to_string(found.where().line);
    }
    return std::string("no error");
  };
  const auto of_head = [&](const std::string& more) {
    return error(head.substr(0, head.size() - 1) + "," + more + "}\n");
  };
  EXPECT_EQ(
      error(head + "\n" + R"({"frame":0,"labels":[{"track":1,"category":"a","class":"plane",)" +
            R"("box_px":[1,2,3,4]}]})"),
      "labels[0].class is \"plane\"; expected aircraft, bird, multirotor, balloon, glint, dirt, "
      "insect or ignore at 2");
  // 2^32 + 640 is 640 in 32 bits, and 2^64 - 1 is -1 in 64 bits.
  EXPECT_EQ(of_head(R"("width":4294967936)"),
            "width is 4294967936; expected a whole number from 1 to 1000000 at 1");
  EXPECT_EQ(of_head(R"("height":-4)"),
            "height is -4; expected a whole number from 1 to 1000000 at 1");
  EXPECT_EQ(of_head(R"("width":1e308)"),
            "width is 1e+308; expected a whole number from 1 to 1000000 at 1");
  EXPECT_EQ(of_head(R"("frame_rate_hz":0)"),
            "frame_rate_hz is 0; expected a number above 0, up to 1000000 at 1");
  EXPECT_EQ(of_head(R"("frame_rate_hz":"x")"), "frame_rate_hz is \"x\"; expected a number at 1");
  EXPECT_EQ(error(head + "\n{\"frame\":18446744073709551615,\"labels\":[]}\n"),
            "frame is 18446744073709551615; expected a whole number from 0 to 9007199254740992 at "
            "2");
  EXPECT_EQ(error(head + "\n{\"frame\":0.5,\"labels\":[]}\n"),
            "frame is 0.5; expected a whole number from 0 to 9007199254740992 at 2");
  EXPECT_EQ(error(head + R"(
{"frame":0,"labels":[{"track":1e30,"category":"a","box_px":[1,2,3,4]}]})"),
            "labels[0].track is 1e+30; expected a whole number from -9007199254740992 to "
            "9007199254740992 at "
            "2");
  EXPECT_EQ(error(head + R"(
{"frame":0,"labels":[{"track":1,"category":"a","box_px":[1,2,3,1e999]}]})"),
            "holds a number that is too large for 64 bits at 2");
  EXPECT_EQ(of_head(R"("width":640,"height":480,"frame_rate_hz":29.97)"), "no error");
}

// Exports and runs name their files by it.
TEST(Labels, NamesLeadNowhereElse) {
  const Folder folder;
  const auto is_read = [&](const std::string& name, const std::string& picture) {
    try {
      read_labels(folder.file("labels.jsonl",
                              R"({"format":"airtruth labels 1","name":")" + name +
                                  "\"}\n{\"frame\":0,\"picture\":\"" + picture +
                                  "\",\"labels\":[]}\n"));
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(error.where().line, picture == "p" ? 1 : 2) << error.what();
      return false;
    }
  };
  EXPECT_TRUE(is_read("night-1.b", "p"));
  for (const std::string name :
       {"../x", "/x", "a/b", "..", ".", "", ".hid", "a\\nb", "a\\u0000b", "a\\u007f"})
    EXPECT_FALSE(is_read(name, "p")) << name;
  EXPECT_FALSE(is_read(std::string(201, 'a'), "p"));
  EXPECT_TRUE(is_read("a", "part/p.png"));
  EXPECT_FALSE(is_read("a", "p\\u0000.png"));
}

// Small files that state frames by their count, and boxes up to the next one.
TEST(Frames, OfAnImportHaveABound) {
  const Folder folder;
  const ReadOptions options;
  const Warn warn;
  LeftOut left_out(warn);
  std::map<std::string, std::string> classes;
  const auto error = [&](Format format, ReadFormat* read, const char* place, std::size_t room) {
    std::size_t filled = kMostFilled - room;
    const fs::path source = folder.path() / place;
    return test_support::error_of([&] {
      read({format, source, options, warn, left_out, classes, filled});
    });
  };
  folder.file("c.xml",
              "<annotations><meta><task><name>s</name><size>90</size></task></meta>"
              "<track id=\"0\" label=\"a\"><box frame=\"0\" xtl=\"1\" ytl=\"1\" xbr=\"4\" "
              "ybr=\"5\"/></track></annotations>");
  folder.file("m/a/seqinfo.ini", "seqLength=90\n");
  folder.file("m/a/gt/gt.txt", "1,1,1,1,3,3,1,1,1\n");
  folder.file("a.json", R"({"samples":{"f":{"metadata":{"number_of_frames":90},"entities":[]}}})");
  const auto expect_bound = [&](Format format, ReadFormat* read, const char* place, int fits) {
    EXPECT_EQ(error(format, read, place, static_cast<std::size_t>(fits)), "no error");
    const std::string found = error(format, read, place, static_cast<std::size_t>(fits) - 1);
    EXPECT_NE(found.find("states more than 10000000 frames and boxes"), std::string::npos) << found;
  };
  expect_bound(Format::kCvat, read_cvat, "c.xml", 180);
  expect_bound(Format::kMot, read_mot, "m", 90);
  expect_bound(Format::kAot, read_aot, "a.json", 90);
}

// Ids without a number take the first that is free, those with one the first from it on.
TEST(Aot, ManyIdsHaveTracksOfTheirOwn) {
  const Folder folder;
  std::string entities;
  const auto add = [&](const std::string& id) {
    entities += fmt::format(
        R"({}{{"blob":{{"frame":0}},"id":"{}","bb":[1,2,3,4]}})", entities.empty() ? "" : ",", id);
  };
  const int count = 20'000;
  for (int i = 0; i < count; ++i) add(fmt::format("a{}x", i));
  for (int i = 1; i <= count; ++i) add(fmt::format("Airplane{}", i));
  const std::string text = R"({"samples":{"f":{"metadata":{},"entities":[)" + entities + "]}}}";
  const auto clips = read_clips(Format::kAot, folder.file("a.json", text), {}, {});
  const std::vector<std::int64_t> tracks = tracks_of(clips.at(0));
  ASSERT_EQ(std::ssize(tracks), 2 * count);
  EXPECT_EQ(tracks.back(), 2 * count);
  EXPECT_EQ(clips[0].frames.at(0).labels.at(5).track, 6);
  EXPECT_EQ(clips[0].frames.at(0).labels.at(count).track, count + 1);
}

TEST(Labels, ATrackIsOnceInAFrame) {
  const Folder folder;
  const auto of = [&](const std::string& second) {
    const fs::path file = folder.file("labels.jsonl",
                                      R"({"format":"airtruth labels 1","name":"s"}
{"frame":4,"labels":[{"track":1,"category":"a","box_px":[1,2,3,4]},)" +
                                          second + "]}\n");
    return read_labels(file);
  };
  EXPECT_EQ(of(R"({"track":1,"class":"ignore","category":"a","box_px":[1,2,3,4]})").frames.size(),
            1u);
  try {
    of(R"({"track":1,"category":"b","box_px":[5,2,3,4]})");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.message(), "has the track 1 a second time in frame 4");
    EXPECT_EQ(error.where().line, 2);
  }
  const std::string entity =
      R"({"time": 1, "blob": {"frame": 0}, "id": "Airplane7", "bb": [1, 2, 3, 4]})";
  const std::string error =
      error_of(Format::kAot,
               folder.file("aot.json",
                           R"({"samples": {"f": {"metadata": {}, "entities": [)" + entity + "," +
                               entity + "]}}}"));
  EXPECT_TRUE(error.ends_with("aot.json: 'f' has the track 7 a second time in frame 0")) << error;
}

}  // namespace
}  // namespace airtruth::exchange
