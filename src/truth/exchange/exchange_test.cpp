// SPDX-License-Identifier: Apache-2.0
#include "truth/exchange/exchange.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "truth/exchange/text.h"

namespace airtruth::exchange {
namespace {

class Folder {
 public:
  Folder()
      : path_(fs::temp_directory_path() /
              ("airtruth_exchange_" + std::to_string(std::random_device{}()))) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }
  fs::path file(const std::string& name, const std::string& text) const {
    fs::create_directories((path_ / name).parent_path());
    write_file(path_ / name, text);
    return path_ / name;
  }

 private:
  fs::path path_;
};

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  bool often(double share) { return number(0, 1) < share; }

  // Boxes of whole and of fractional pixels, also at the picture's edges.
  Box box(int width, int height) {
    if (often(0.2)) return {0, 0, double(whole(1, width)), double(whole(1, height))};
    if (often(0.2)) return {double(width - 1), double(height - 1), 1, 1};
    if (often(0.5)) {
      const int x = whole(0, width - 2), y = whole(0, height - 2);
      return {double(x), double(y), double(whole(1, width - x)), double(whole(1, height - y))};
    }
    return {number(-3, width - 4), number(-3, height - 4), number(3.5, 40), number(3.5, 40)};
  }

  Clip clip(const std::string& name) {
    Clip clip;
    clip.name = name;
    clip.width = whole(64, 2000);
    clip.height = whole(48, 1500);
    clip.frame_rate_hz = often(0.5) ? 30 : 30000.0 / 1001;
    const int frames = whole(1, 25);
    const int tracks = whole(0, 3);
    std::vector<std::string> categories;
    for (int t = 0; t < tracks; ++t) categories.push_back(often(0.5) ? "738" : "c172 \"<&> é");
    for (int f = 0; f < frames; ++f) {
      LabelledFrame frame{f, f / *clip.frame_rate_hz, {}};
      const bool empty = often(0.2) || (f == 0 && often(0.5));
      for (int t = 0; t < tracks && !empty; ++t) {
        if (often(0.3)) continue;
        Label label;
        label.track = t + 1;
        label.category = categories[static_cast<std::size_t>(t)];
        label.box_px = box(clip.width, clip.height);
        label.visible = often(0.5) ? 1 : number(0, 1);
        label.occluded = often(0.3);
        label.truncated = often(0.3);
        label.range_m = number(10, 3000);
        label.above_horizon = often(0.5);
        frame.labels.push_back(label);
      }
      clip.frames.push_back(frame);
    }
    return clip;
  }

 private:
  std::mt19937 random_;
};

constexpr Format kWritten[] = {Format::kCoco,
                               Format::kYolo,
                               Format::kMot,
                               Format::kVoc,
                               Format::kCvat,
                               Format::kAot,
                               Format::kOtb,
                               Format::kGot10k,
                               Format::kVot};

// The clip without the information that the format cannot store, as LOSS.md states.
Clip held(Format format, Clip clip) {
  const bool named_frames_only = format == Format::kYolo || format == Format::kVoc;
  if (named_frames_only || format == Format::kOtb || format == Format::kCvat)
    clip.frame_rate_hz.reset();
  std::int64_t number = 0;
  for (LabelledFrame& frame : clip.frames) {
    frame.frame = number++;
    if (format != Format::kCoco && format != Format::kAot) frame.time_s.reset();
    std::int64_t place = 0;
    for (Label& label : frame.labels) {
      ++place;
      if (named_frames_only) label.track = place;
      if (named_frames_only) label.box_px = *clipped(label.box_px, clip.width, clip.height);
      // VOC stores whole pixels.
      if (format == Format::kVoc) {
        const PixelBox pixels = pixels_of(label.box_px);
        label.box_px = {
            double(pixels.x), double(pixels.y), double(pixels.width), double(pixels.height)};
      }
      if (is_single_object(format)) label.track = 1;
      if (format == Format::kOtb) label.category = "aircraft";
      if (format != Format::kCoco && format != Format::kMot && format != Format::kCvat &&
          format != Format::kGot10k)
        label.visible.reset();
      // The format stores eighths, each of which is read as its middle.
      if (format == Format::kGot10k && *label.visible > 0 && *label.visible < 1)
        label.visible = 0.15 * std::min(7.0, std::ceil(*label.visible / 0.15)) - 0.075;
      if (format != Format::kCoco && format != Format::kVoc && format != Format::kCvat &&
          format != Format::kVot)
        label.occluded.reset();
      if (format != Format::kCoco && format != Format::kVoc && format != Format::kCvat &&
          format != Format::kGot10k)
        label.truncated.reset();
      if (format != Format::kCoco && format != Format::kMot && format != Format::kCvat &&
          format != Format::kAot && format != Format::kVot)
        label.range_m.reset();
      if (format != Format::kCoco && format != Format::kCvat && format != Format::kAot)
        label.above_horizon.reset();
    }
  }
  return clip;
}

void expect_near(const std::optional<double>& a, const std::optional<double>& b, double tolerance) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (a) {
    EXPECT_NEAR(*a, *b, tolerance);
  }
}

void expect_same(const Clip& read, const Clip& expected) {
  EXPECT_EQ(read.name, expected.name);
  EXPECT_EQ(read.width, expected.width);
  EXPECT_EQ(read.height, expected.height);
  expect_near(read.frame_rate_hz, expected.frame_rate_hz, 1e-12);
  ASSERT_EQ(read.frames.size(), expected.frames.size());
  for (std::size_t i = 0; i < read.frames.size(); ++i) {
    SCOPED_TRACE("frame " + std::to_string(i));
    EXPECT_EQ(read.frames[i].frame, expected.frames[i].frame);
    expect_near(read.frames[i].time_s, expected.frames[i].time_s, 1e-9);
    ASSERT_EQ(read.frames[i].labels.size(), expected.frames[i].labels.size());
    for (std::size_t k = 0; k < read.frames[i].labels.size(); ++k) {
      const Label& a = read.frames[i].labels[k];
      const Label& b = expected.frames[i].labels[k];
      EXPECT_EQ(a.track, b.track);
      EXPECT_EQ(a.category, b.category);
      EXPECT_NEAR(a.box_px.x, b.box_px.x, 1e-9);
      EXPECT_NEAR(a.box_px.y, b.box_px.y, 1e-9);
      EXPECT_NEAR(a.box_px.width, b.box_px.width, 1e-9);
      EXPECT_NEAR(a.box_px.height, b.box_px.height, 1e-9);
      expect_near(a.visible, b.visible, 1e-12);
      EXPECT_EQ(a.occluded, b.occluded);
      EXPECT_EQ(a.truncated, b.truncated);
      expect_near(a.range_m, b.range_m, 1e-12);
      EXPECT_EQ(a.above_horizon, b.above_horizon);
    }
  }
}

TEST(RoundTrip, EveryFormatKeepsAllThatItCanHold) {
  for (const Format format : kWritten) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE(std::string(name(format)) + ", seed " + std::to_string(seed));
      const Folder folder;
      Draw draw(seed);
      std::vector<Clip> clips = {draw.clip("a"), draw.clip("b-2 c"), draw.clip("c_7")};
      // The user must state the size for YOLO, OTB, GOT-10k and VOT.
      for (Clip& clip : clips) std::tie(clip.width, clip.height) = std::pair(2000, 1500);
      WriteOptions options;
      options.categories = {"738", "c172 \"<&> é"};
      options.parts = {"train", "val"};
      auto writer = make_writer(format, folder.path(), options);
      std::vector<Clip> expected;
      for (std::size_t i = 0; i < clips.size(); ++i)
        for (const Clip& clip : arranged(format, clips[i])) {
          writer->add(clip, i == 1 ? "val" : "train");
          expected.push_back(held(format, clip));
        }
      writer->finish();
      std::vector<Clip> read;
      if (!expected.empty())
        read = read_clips(format, folder.path(), {{{2000, 1500}}, "aircraft"}, {});
      ASSERT_EQ(read.size(), expected.size());
      const auto by_name = [](const Clip& a, const Clip& b) { return a.name < b.name; };
      std::sort(read.begin(), read.end(), by_name);
      std::sort(expected.begin(), expected.end(), by_name);
      for (std::size_t i = 0; i < read.size(); ++i) expect_same(read[i], expected[i]);
      if (HasFailure()) return;
    }
  }
}

// write_clips() names the classes and the parts itself and writes no pictures.
TEST(RoundTrip, OfASetThatIsWrittenAtOnce) {
  Clip clip;
  clip.name = "s";
  clip.width = 64;
  clip.height = 48;
  Label label;
  label.category = "738";
  label.box_px = {3, 4, 8, 5};
  clip.frames = {{0, std::nullopt, {label}}, {1, std::nullopt, {label}}};
  const Folder folder;
  const Part parts[] = {{"train", {clip}}, {"val", {clip}}};
  write_clips(Format::kCoco, folder.path() / "coco", parts);
  const auto read = read_clips(Format::kCoco, folder.path() / "coco", {}, {});
  ASSERT_EQ(read.size(), 2u);
  for (const Clip& one : read) {
    ASSERT_EQ(one.frames.size(), 2u);
    EXPECT_EQ(one.frames[1].labels.at(0).box_px, label.box_px);
    EXPECT_EQ(one.frames[1].labels.at(0).category, "738");
  }
  EXPECT_THROW(write_clips(Format::kCoco, folder.path() / "coco", parts), Error);
  EXPECT_THROW(write_clips(Format::kCsv, folder.path() / "csv", parts), Error);
}

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

// An import contains only boxes and tracks. Columns that a format requires are written all the same
// and are read back as unknown.
TEST(RoundTrip, WhatIsUnknownComesBackAsUnknown) {
  Clip clip;
  clip.name = "s";
  clip.width = 64;
  clip.height = 48;
  Label label;
  label.category = "738";
  label.box_px = {3, 4, 8, 5};
  clip.frames = {{0, std::nullopt, {label}}, {1, std::nullopt, {}}, {2, std::nullopt, {label}}};
  for (const Format format : kWritten) {
    SCOPED_TRACE(name(format));
    const Folder folder;
    auto writer = make_writer(format, folder.path(), {{"738"}, {"train"}, ".jpg"});
    for (const Clip& one : arranged(format, clip)) writer->add(one, "train");
    writer->finish();
    const auto read = read_clips(format, folder.path(), {{{64, 48}}, "738"}, {});
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read[0].frame_rate_hz, std::nullopt);
    ASSERT_EQ(read[0].frames.size(), 3u);
    Clip expected = clip;
    // CVAT states for every box whether it is occluded.
    if (format == Format::kCvat)
      for (LabelledFrame& frame : expected.frames)
        for (Label& each : frame.labels) each.occluded = false;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(read[0].frames[i].time_s, std::nullopt);
      ASSERT_EQ(read[0].frames[i].labels.size(), expected.frames[i].labels.size());
      if (i == 1) continue;
      Label got = read[0].frames[i].labels[0];
      EXPECT_NEAR(got.box_px.x, 3, 1e-9);  // YOLO's shares
      got.box_px = label.box_px;
      EXPECT_EQ(got, expected.frames[i].labels[0]);
    }
  }
}

TEST(RoundTrip, LabelsOfOurOwnKeepEverything) {
  const Folder folder;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Clip clip = Draw(seed).clip("x");
    clip.media = "some/video.mp4";
    for (LabelledFrame& frame : clip.frames)
      for (Label& label : frame.labels)
        label.object_class = label.track % 3 == 0   ? "bird"
                             : label.track % 3 == 1 ? "ignore"
                                                    : "aircraft";
    const Clip again = read_labels(folder.file("labels.jsonl", labels_jsonl(clip)));
    EXPECT_EQ(again.media, clip.media);
    expect_same(again, clip);
    EXPECT_EQ(again.frames, clip.frames);
  }
}

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

TEST(Coco, CrowdsAreNoObjectsAndPicturesOfSeveralSizesAreNoVideo) {
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
  ASSERT_EQ(clips[0].frames[0].labels.size(), 1u);
  EXPECT_EQ(clips[0].frames[0].labels[0].box_px, (Box{1, 2, 3, 4}));
  EXPECT_NE(warnings.find("1 crowds (iscrowd = 1), which are regions and no objects (the first: "
                          "annotations[1])"),
            std::string::npos)
      << warnings;
  EXPECT_NE(warnings.find("differ in size"), std::string::npos) << warnings;
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
    <box label="bird" occluded="0" xtl="30" ytl="4" xbr="32" ybr="9"/></image>
</annotations>)");
  const auto clips = read_clips(Format::kCvat, file, {}, {});
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].width, 64);
  ASSERT_EQ(clips[0].frames.size(), 2u);
  EXPECT_TRUE(clips[0].frames[0].labels.empty());
  ASSERT_EQ(clips[0].frames[1].labels.size(), 2u);
  const Label& plane = clips[0].frames[1].labels[0];
  EXPECT_EQ(plane.box_px, (Box{3.5, 4, 10, 5}));
  EXPECT_EQ(plane.category, "plane");
  EXPECT_EQ(plane.occluded, true);
  EXPECT_EQ(plane.range_m, 700);
  EXPECT_EQ(clips[0].frames[1].labels[1].track, 2);
}

std::string error_of(Format format, const fs::path& source) {
  try {
    read_clips(format, source, {}, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
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
  folder.file("o/groundtruth_rect.txt", "1,2,3,4\n1,2,x,4\n");
  ends(error_of(Format::kOtb, folder.path() / "o"),
       "groundtruth_rect.txt:2:5: 'x' is not a number");
  folder.file("mask/groundtruth.txt", "m0,0,4,2,3,6\n");
  ends(error_of(Format::kVot, folder.path() / "mask"),
       "groundtruth.txt:1: is no mask: its run lengths do not fit its window");
  ends(error_of(Format::kAot, folder.file("n.json", "{\"samples\": NaN}")),
       "n.json: samples is null; expected an object");
  ends(error_of(Format::kVoc, folder.file("v/p_1.xml", "<annotation>\n<size>")),
       "p_1.xml: holds no Annotations/*.xml");
  ends(error_of(Format::kCsv, folder.file("t.csv", "frame,x,y,w,h\n0,1,2,3\n")),
       "t.csv:2: has 4 columns; expected frame,x,y,w,h");
  ends(error_of(Format::kYolo, folder.path() / "nowhere"), "nowhere: does not exist");
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

}  // namespace
}  // namespace airtruth::exchange
