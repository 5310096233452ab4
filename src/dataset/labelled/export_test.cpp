// SPDX-License-Identifier: Apache-2.0
#include "dataset/labelled/export.h"

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dataset/build/build.h"
#include "dataset/build/verify.h"
#include "dataset/labelled/import.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/image/colour.h"
#include "foundation/tar/tar.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "sequence/replay/finished.h"
#include "support/error_of.h"
#include "support/small_catalogue.h"
#include "support/temporary_folder.h"

namespace airtruth::labelled {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A small data set, made once for all tests of this file.
class Made : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = temporary_.emplace().path();
    write_file(root_ / "c.toml", std::string(test_support::kCatalogue) + "masks = true\n");
    const build::BuildSummary summary =
        build::build_set(catalogue::read_catalogue(root_ / "c.toml"), set(), {});
    ASSERT_EQ(summary.made, 4);
  }
  static void TearDownTestSuite() { temporary_.reset(); }

  static fs::path set() { return root_ / "set"; }
  fs::path fresh() {
    static int number = 0;
    return root_ / ("out" + std::to_string(number++));
  }
  static std::set<std::string> files(const fs::path& folder) {
    std::set<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) found.insert(fs::relative(entry.path(), folder).string());
    return found;
  }
  // Copies the set, changes the first frame's truth of one sequence, and updates its record to
  // match.
  fs::path changed(const std::string& sequence,
                   const std::function<void(nlohmann::ordered_json&)>& change) {
    const fs::path copy = fresh();
    fs::copy(set(), copy, fs::copy_options::recursive);
    const fs::path folder = copy / "sequences" / sequence;
    std::string truth = read_file(folder / "truth.jsonl");
    const std::size_t end = truth.find('\n');
    auto line = nlohmann::ordered_json::parse(truth.substr(0, end));
    change(line["intruders"][0]);
    const std::string before = sha256_of(truth);
    truth = line.dump() + truth.substr(end);
    write_file(folder / "truth.jsonl", truth);
    std::string record = read_file(folder / "sequence.json");
    record.replace(record.find(before), before.size(), sha256_of(truth));
    write_file(folder / "sequence.json", record);
    build::finish(copy);  // writes the manifest as well
    return copy;
  }
  static inline std::optional<test_support::TemporaryFolder> temporary_;
  inline static fs::path root_;
};

const std::vector<exchange::Format> kAll = {exchange::Format::kCoco,
                                            exchange::Format::kYolo,
                                            exchange::Format::kMot,
                                            exchange::Format::kVoc,
                                            exchange::Format::kCvat,
                                            exchange::Format::kAot,
                                            exchange::Format::kOtb,
                                            exchange::Format::kGot10k,
                                            exchange::Format::kVot};

TEST_F(Made, EveryFormatComesBackWithTheBoxesOfTheTruthAndPicturesOfTheVideo) {
  const LabelledSet made(set());
  for (const exchange::Format format : kAll) {
    SCOPED_TRACE(exchange::name(format));
    ExportOptions options;
    options.format = format;
    options.images = Images::kPng;
    const fs::path out = fresh();
    const ExportSummary summary = export_set(set(), out, options);
    EXPECT_EQ(summary.sequences, 4);
    EXPECT_EQ(summary.frames, 32);
    EXPECT_TRUE(fs::exists(out / "LOSS.md"));
    EXPECT_FALSE(fs::exists(out / ".export"));
    ImportOptions back;
    back.format = format;
    const fs::path again = fresh();
    EXPECT_EQ(import_set(out, again, back).clips, 4);
    const LabelledSet read(again);
    EXPECT_EQ(read.names(), made.names());
    for (const std::string& name : made.names()) {
      const auto expected = exchange::arranged(format, made.clip(name)).at(0);
      const exchange::Clip clip = read.clip(name);
      EXPECT_EQ(read.facts(name).background_name, name);  // its pictures are no other clip's
      ASSERT_EQ(clip.frames.size(), expected.frames.size());
      EXPECT_EQ(clip.width, 160);
      for (std::size_t i = 0; i < clip.frames.size(); ++i) {
        ASSERT_EQ(clip.frames[i].labels.size(), expected.frames[i].labels.size());
        if (clip.frames[i].labels.empty()) continue;
        EXPECT_NEAR(clip.frames[i].labels[0].box_px.x, expected.frames[i].labels[0].box_px.x, 1e-9);
      }
      // The exported picture of the second frame equals the video's, so boxes and pixels belong to
      // the same frame.
      video::Reader pictures(clip.media);
      video::Reader frames(expected.media);
      for (std::size_t i = 0; i < clip.frames.size(); ++i) {
        auto frame = frames.next();
        while (frame->index < expected.frames[i].frame) frame = frames.next();
        const image::Rgb8 a = image::rgb8_from_picture(pictures.next()->picture);
        const image::Rgb8 b = image::rgb8_from_picture(frame->picture);
        ASSERT_TRUE(std::equal(a.at(0, 0), a.at(0, 0) + 3 * 160 * 120, b.at(0, 0))) << name;
      }
    }
  }
}

TEST_F(Made, AnExportGoesOnWhereItStoppedAndTheSecondRunCostsNothing) {
  for (const exchange::Format format : {exchange::Format::kMot, exchange::Format::kWebdataset}) {
    SCOPED_TRACE(exchange::name(format));
    ExportOptions options;
    options.format = format;
    const fs::path whole = fresh();
    export_set(set(), whole, options);
    const fs::path out = fresh();
    std::stop_source source;
    ExportOptions stopped = options;
    stopped.jobs = 1;
    stopped.stop = source.get_token();
    stopped.progress = [&](std::int64_t done, std::int64_t) {
      if (done == 2) source.request_stop();
    };
    EXPECT_THROW(export_set(set(), out, stopped), Interrupted);
    EXPECT_FALSE(fs::exists(out / "export.json"));
    const ExportSummary rest = export_set(set(), out, options);
    EXPECT_EQ(rest.images, 16);  // of 32
    EXPECT_EQ(files(out), files(whole));
    for (const std::string& name : files(out))
      EXPECT_EQ(sha256_of_file(out / name), sha256_of_file(whole / name)) << name;
    EXPECT_TRUE(export_set(set(), out, options).was_there);
  }
}

TEST_F(Made, ShardsHoldThePicturesAndLabelsOfOtherFormats) {
  ExportOptions options;
  options.split = Split::kNone;
  options.images = Images::kPng;
  options.format = exchange::Format::kYolo;
  const fs::path yolo = fresh();
  export_set(set(), yolo, options);
  options.format = exchange::Format::kWebdataset;
  options.shard_mb = 1;
  const fs::path out = fresh();
  EXPECT_EQ(export_set(set(), out, options).images, 32);
  EXPECT_THAT(files(out), testing::IsSupersetOf({"LOSS.md", "all-000000.tar", "export.json"}));
  int pictures = 0;
  for (const auto& shard : fs::directory_iterator(out)) {
    if (shard.path().extension() != ".tar") continue;
    EXPECT_LT(fs::file_size(shard), 1'100'000);
    tar::each_file(shard, ".png", [&](const std::string& name, const std::string& bytes) {
      ++pictures;
      EXPECT_EQ(bytes, read_file(yolo / "images/all" / name)) << name;
    });
  }
  EXPECT_EQ(pictures, 32);
  ImportOptions back;
  back.format = exchange::Format::kWebdataset;
  const fs::path again = fresh();
  import_set(out, again, back);
  const LabelledSet made(set()), read(again);
  ASSERT_EQ(read.names(), made.names());
  for (const std::string& name : made.names())
    EXPECT_EQ(read.clip(name).frames, made.clip(name).frames);
  options.format = exchange::Format::kYolo;
  EXPECT_THROW(export_set(set(), fresh(), options), Error);
}

TEST_F(Made, AnExportKilledBeforeItsOptionsAreWrittenIsBegunAnew) {
  const fs::path out = fresh();
  fs::create_directories(out / ".export/done");
  EXPECT_GT(export_set(set(), out, {}).frames, 0);
  EXPECT_TRUE(fs::exists(out / "export.json"));
  EXPECT_FALSE(fs::exists(out / ".export"));
}

TEST_F(Made, AnExportOfRendersNoticesThatOneHasChanged) {
  const fs::path renders = fresh(), out = fresh();
  fs::copy(set() / "sequences", renders, fs::copy_options::recursive);
  export_set(renders, out, {});
  EXPECT_TRUE(export_set(renders, out, {}).was_there);
  const fs::path record = renders / LabelledSet(renders).names()[0] / "sequence.json";
  write_file(record, read_file(record) + "\n");
  EXPECT_THAT(test_support::error_of([&] { export_set(renders, out, {}); }),
              testing::HasSubstr("holds an export of another set"));
}

TEST_F(Made, AnExportNoticesThatASequenceIsAwayOrBack) {
  const fs::path copy = fresh(), whole = fresh(), part = fresh();
  fs::copy(set(), copy, fs::copy_options::recursive);
  const ExportOptions options{.images = Images::kNone};
  EXPECT_EQ(export_set(copy, whole, options).sequences, 4);
  const fs::path sequence = copy / "sequences" / LabelledSet(copy).names().front();
  const fs::path away = fresh();
  fs::rename(sequence, away);
  EXPECT_THROW(export_set(copy, whole, options), Error);
  EXPECT_EQ(export_set(copy, part, options).sequences, 3);
  EXPECT_TRUE(export_set(copy, part, options).was_there);
  fs::rename(away, sequence);
  EXPECT_THROW(export_set(copy, part, options), Error);
  EXPECT_TRUE(export_set(copy, whole, options).was_there);
}

TEST_F(Made, AnExportOverSomethingElseIsRefused) {
  const auto error = [](const fs::path& out, const ExportOptions& options) -> std::string {
    return test_support::error_of([&] { export_set(set(), out, options); });
  };
  const fs::path out = fresh();
  fs::create_directories(out);
  write_file(out / "mine.txt", "precious");
  EXPECT_THAT(error(out, {}), HasSubstr("exists and is not empty"));
  EXPECT_THAT(files(out), ElementsAre("mine.txt"));
  const fs::path other = fresh();
  ExportOptions options;
  options.images = Images::kNone;
  export_set(set(), other, options);
  options.every = 2;
  EXPECT_THAT(error(other, options), HasSubstr("made with other options"));
  EXPECT_THAT(error(fresh() / "x", {.jobs = 1}), "no error");
}

TEST_F(Made, CountsOfRecordsThatWereChangedAreOneLine) {
  const auto changed = [](const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = read_file(file);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << file;
    write_file(file, text.replace(at, from.size(), to));
  };
  const fs::path out = fresh();
  ExportOptions options;
  options.images = Images::kNone;
  export_set(set(), out, options);
  // A run that was killed at its last step leaves this folder.
  fs::create_directories(out / ".export" / "done");
  EXPECT_TRUE(export_set(set(), out, options).was_there);
  EXPECT_FALSE(fs::exists(out / ".export"));
  changed(out / "export.json", "\"frames\": 32", "\"frames\": 1e308");
  try {
    export_set(set(), out, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.message(),
              "summary.frames is 1e+308; expected a whole number from 0 to 9007199254740992");
  }
  const fs::path copy = fresh();
  fs::copy(set(), copy, fs::copy_options::recursive);
  const LabelledSet labelled(copy);
  const std::string first = labelled.names().front();
  // 2^64 - 1 would become -1 in a signed 64-bit integer.
  changed(labelled.folder(first) / "sequence.json",
          "\"frames\": 8",
          "\"frames\": 18446744073709551615");
  try {
    labelled.facts(first);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.message(),
              "summary.frames is 18446744073709551615; expected a whole number from 0 to "
              "9007199254740992");
  }
}

TEST_F(Made, ABackgroundIsInOnePartAloneUnlessAskedFor) {
  std::vector<std::string> warnings;
  ExportOptions options;
  options.format = exchange::Format::kMot;
  options.images = Images::kNone;
  options.shares = {0.5, 0.5, 0};
  options.warn = [&](const std::string& w) { warnings.push_back(w); };
  const fs::path out = fresh();
  const ExportSummary summary = export_set(set(), out, options);
  EXPECT_THAT(warnings, ElementsAre());
  EXPECT_EQ(summary.frames_of_part,
            (std::map<std::string, std::int64_t>{{"train", 16}, {"val", 16}}));
  for (const char* part : {"train", "val"}) {
    std::set<std::string> backgrounds;
    for (const auto& entry : fs::directory_iterator(out / part))
      backgrounds.insert(entry.path().filename().string().substr(0, 3));
    EXPECT_EQ(backgrounds.size(), 1u) << part;
  }
  options.split = Split::kBySequence;
  options.shares = {0.75, 0.25, 0};
  export_set(set(), fresh(), options);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("in more than one part")));
}

TEST_F(Made, EveryNthFrameAndOneClass) {
  ExportOptions options;
  options.format = exchange::Format::kYolo;
  options.images = Images::kNone;
  options.every = 3;
  options.one_class = true;
  options.split = Split::kNone;
  const fs::path out = fresh();
  EXPECT_EQ(export_set(set(), out, options).frames, 12);
  EXPECT_THAT(read_file(out / "data.yaml"), HasSubstr("0: \"aircraft\"\n"));
  const auto truth = LabelledSet(set()).clip("sky-across-b737");
  ASSERT_FALSE(truth.frames[3].labels.empty());
  const std::string second = read_file(out / "labels/all/sky-across-b737_000001.txt");
  const Box& box = truth.frames[3].labels[0].box_px;
  EXPECT_THAT(
      second,
      testing::StartsWith("0 " + std::to_string((box.x + box.width / 2) / 160).substr(0, 5)));
}

// The numbers and names of a set are the same in each export of it.
TEST_F(Made, CocoHasTheIdsAndNamesOfTheWholeSet) {
  const auto images_of = [&](const fs::path& source, Split split) {
    const fs::path out = fresh();
    export_set(source, out, {.images = Images::kNone, .every = 3, .split = split});
    std::map<std::string, std::int64_t> images;
    for (const fs::path& file : entries(out / "annotations")) {
      const auto json = nlohmann::json::parse(read_file(file));
      for (const auto& image : json.at("images")) images[image.at("file_name")] = image.at("id");
    }
    return images;
  };
  const auto images = images_of(set(), Split::kNone);  // four clips of 8 frames
  EXPECT_EQ(images.size(), 12U);
  EXPECT_EQ(images.at("more-across-b737/000003.jpg"), 4);
  EXPECT_EQ(images.at("sky-across-c172/000006.jpg"), 3 * 8 + 7);
  EXPECT_EQ(images_of(set(), Split::kBySequence), images);
  const fs::path source = fresh();
  fs::create_directories(source);
  write_file(source / "a.json",
             R"({"categories": [{"id": 1, "name": "bird"}, {"id": 7, "name": "plane"}],
    "images": [{"id": 90, "file_name": "f/000012.png", "width": 64, "height": 48},
               {"id": 80, "file_name": "f/000018.png", "width": 64, "height": 48}],
    "annotations": [{"id": 1, "image_id": 80, "category_id": 7, "bbox": [1, 2, 3, 4]}]})");
  const fs::path imported = fresh();
  import_set(source, imported, {});
  EXPECT_EQ(images_of(imported, Split::kNone),
            (std::map<std::string, std::int64_t>{{"f/000012.jpg", 90}, {"f/000018.jpg", 80}}));
  const fs::path out = fresh();
  export_set(imported, out, {.images = Images::kNone, .split = Split::kNone, .one_class = true});
  EXPECT_EQ(nlohmann::json::parse(read_file(out / "annotations/instances_all.json"))
                .at("annotations")
                .at(0)
                .at("category_id"),
            7);
}

// Labels of frames 3, 8, 13 and 18 of a video of 25 frames a second are 0.2 s apart.
TEST_F(Made, TheRateIsThatOfTheFramesThatAreExported) {
  std::string images, boxes;
  for (int i = 0; i < 4; ++i) {
    const char* comma = i > 0 ? "," : "";
    images += fmt::format(R"({}{{"id":{},"file_name":"clip/{:06}.jpg","width":64,"height":48}})",
                          comma,
                          i,
                          3 + 5 * i);
    boxes += fmt::format(
        R"({}{{"id":{},"image_id":{},"category_id":1,"bbox":[9,9,6,4]}})", comma, i + 1, i);
  }
  const fs::path json = fresh().replace_extension(".json");
  write_file(json,
             R"({"categories":[{"id":1,"name":"aircraft"}],"images":[)" + images +
                 R"(],"annotations":[)" + boxes + "]}");
  const fs::path imported = fresh();
  import_set(json, imported, {.format = exchange::Format::kCoco, .frame_rate_hz = 25});
  std::vector<std::string> warnings;
  ExportOptions options;
  options.format = exchange::Format::kMot;
  options.images = Images::kNone;
  options.split = Split::kNone;
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  const fs::path out = fresh();
  EXPECT_EQ(export_set(imported, out, options).frames, 4);
  EXPECT_THAT(read_file(out / "all/clip/seqinfo.ini"), HasSubstr("frameRate=5\n"));
  EXPECT_THAT(warnings, testing::IsEmpty());
  options.every = 5;
  EXPECT_EQ(export_set(imported, fresh(), options).frames, 0);
  EXPECT_THAT(warnings, ElementsAre("clip has no frame whose number is a multiple of 5"));
}

TEST_F(Made, SequencesThatAFormatLeavesOutAreNotCounted) {
  std::vector<std::string> warnings;
  ExportOptions options;
  options.format = exchange::Format::kOtb;
  options.images = Images::kNone;
  options.every = 8;  // of 8 frames, which leaves one: no sequence for a toolkit of one object
  options.warn = [&](const std::string& text) { warnings.push_back(text); };
  const ExportSummary summary = export_set(set(), fresh(), options);
  EXPECT_EQ(std::ranges::count_if(
                warnings, [](const auto& text) { return text.ends_with("it is left out"); }),
            4);
  EXPECT_EQ(summary.sequences, 0);
  EXPECT_EQ(summary.frames, 0);
  for (const auto& [part, frames] : summary.frames_of_part) EXPECT_EQ(frames, 0) << part;
}

// The second aircraft is there in the last two of three frames.
TEST_F(Made, EachAircraftIsCountedAsTheSequenceThatItIs) {
  const fs::path mot = fresh();
  fs::create_directories(mot / "a" / "gt");
  write_file(mot / "a" / "gt" / "gt.txt",
             "1,1,5,5,9,9\n2,1,5,5,9,9\n3,1,5,5,9,9\n2,2,30,5,9,9\n3,2,30,5,9,9\n");
  const fs::path imported = fresh();
  ImportOptions source;
  source.format = exchange::Format::kMot;
  import_set(mot, imported, source);
  ExportOptions options;
  options.format = exchange::Format::kOtb;
  options.images = Images::kNone;
  options.split = Split::kNone;
  const fs::path out = fresh();
  for (const bool was_there : {false, true}) {
    const ExportSummary summary = export_set(imported, out, options);
    EXPECT_EQ(summary.was_there, was_there);
    EXPECT_EQ(summary.sequences, 2);
    EXPECT_EQ(summary.frames, 5);
    EXPECT_EQ(summary.frames_of_part, (std::map<std::string, std::int64_t>{{"all", 5}}));
  }
}

TEST_F(Made, LabelsAreTheBoxesThatAreAskedFor) {
  const LabelledSet set_of_boxes(set());
  const std::string name = "sky-across-b737";
  const auto truth = replay::open_finished(set_of_boxes.folder(name)).truth.frames;
  const auto covered = set_of_boxes.clip(name).frames;
  const auto exact = set_of_boxes.clip(name, dataset::Boxes::kExact).frames;
  const auto visible = set_of_boxes.clip(name, dataset::Boxes::kVisible).frames;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const annotation::Intruder& one = truth[k].intruders[0];
    ASSERT_TRUE(one.covered_box_px && one.visible_box_px && one.exact_box_px);
    const PixelBox& c = *one.covered_box_px;
    const PixelBox& v = *one.visible_box_px;
    EXPECT_EQ(covered[k].labels.at(0).box_px,
              (Box{double(c.x), double(c.y), double(c.width), double(c.height)}));
    EXPECT_EQ(visible[k].labels.at(0).box_px,
              (Box{double(v.x), double(v.y), double(v.width), double(v.height)}));
    const Box& e = exact[k].labels.at(0).box_px;
    EXPECT_GE(e.x, 0);
    EXPECT_LE(e.right(), 160);
    if (one.cut_by_frame == 0) {
      EXPECT_EQ(e, *one.exact_box_px);
    }
  }
  ExportOptions options;
  options.format = exchange::Format::kCvat;
  options.images = Images::kNone;
  for (const auto& [boxes, key] : {std::pair(dataset::Boxes::kCovered, "`covered_box_px`"),
                                   std::pair(dataset::Boxes::kExact, "`exact_box_px`"),
                                   std::pair(dataset::Boxes::kVisible, "`visible_box_px`")}) {
    options.boxes = boxes;
    const fs::path out = fresh();
    export_set(set(), out, options);
    EXPECT_THAT(read_file(out / "LOSS.md"), HasSubstr(key));
  }
  EXPECT_EQ(enum_named<dataset::Boxes>("exact"), dataset::Boxes::kExact);
  EXPECT_FALSE(enum_named<dataset::Boxes>("tight"));
}

TEST_F(Made, CocoHoldsThePixelsOfSetsThatHaveMasks) {
  ExportOptions options;
  options.images = Images::kNone;
  options.split = Split::kNone;
  const fs::path out = fresh();
  EXPECT_EQ(export_set(set(), out, options).masks, 32);
  EXPECT_THAT(read_file(out / "LOSS.md"), HasSubstr("`segmentation` of 32 of 32 boxes"));
  const auto coco = nlohmann::json::parse(read_file(out / "annotations/instances_all.json"));
  for (const nlohmann::json& one : coco.at("annotations")) {
    EXPECT_EQ(one.at("segmentation").at("size"), nlohmann::json::parse("[120, 160]"));
    EXPECT_TRUE(one.at("segmentation").at("counts").is_string());
    const auto box = one.at("bbox").get<std::array<double, 4>>();
    EXPECT_GT(one.at("area"), 0.1 * box[2] * box[3]);
    EXPECT_LE(one.at("area"), box[2] * box[3]);
  }
}

TEST_F(Made, VerificationHoldsMasksToTheirBoxes) {
  EXPECT_THAT(build::verify(set(), {}).faults, ElementsAre());
  const fs::path copy = changed("sky-across-c172", [](nlohmann::ordered_json& intruder) {
    intruder["covered_box_px"][2] = intruder["covered_box_px"][2].get<int>() - 1;
  });
  EXPECT_THAT(build::verify(copy, {}).faults,
              testing::Contains(HasSubstr("its mask is not of its covered box")));
}

TEST_F(Made, TruthWithoutCoveredBoxesIsRefusedWithOneLine) {
  const fs::path lacking = changed("sky-across-c172", [](nlohmann::ordered_json& intruder) {
    intruder.erase("covered_box_px");
  });
  ExportOptions options;
  options.images = Images::kNone;
  std::string said = "nothing";
  try {
    export_set(lacking, fresh(), options);
  } catch (const Error& error) {
    said = error.what();
  }
  EXPECT_THAT(said, HasSubstr("truth.jsonl:1: intruders[0] has no covered_box_px"));
  EXPECT_EQ(said.find('\n'), std::string::npos);
}

TEST_F(Made, WhatIsImportedCanBeLookedAt) {
  const fs::path out = fresh();
  ImportOptions options;
  options.format = exchange::Format::kCsv;
  const fs::path csv = root_ / "boxes.csv";
  write_file(csv, "frame,x,y,w,h\n0,10,20,30,40\n5,11.5,20,30,40\n");
  options.videos[""] = LabelledSet(set()).clip("sky-across-b737").media;
  import_set(csv, out, options);
  const auto finished = replay::open_finished(out / "sequences" / "boxes");
  ASSERT_EQ(finished.truth.frames.size(), 6u);
  EXPECT_EQ(*finished.truth.frames[5].intruders[0].visible_box_px, (PixelBox{11, 20, 31, 40}));
  EXPECT_DOUBLE_EQ(finished.truth.frames[5].time_s, 5 / finished.picture_rate_hz.value());
  replay::write_overlay(finished, root_ / "look.mp4", {});
  EXPECT_TRUE(fs::exists(root_ / "look.mp4"));
  EXPECT_THROW(import_set(csv, out, options), Error);
}

TEST_F(Made, AVideoThatIsGivenBelongsToAClip) {
  ImportOptions options;
  options.format = exchange::Format::kCsv;
  fs::create_directories(root_ / "csv");
  write_file(root_ / "csv/A.csv", "frame,x,y,w,h\n0,10,20,30,40\n");
  const fs::path video = LabelledSet(set()).clip("sky-across-b737").media;
  const auto fault_of = [&](const std::map<std::string, fs::path>& videos) {
    options.videos = videos;
    return test_support::error_of([&] { import_set(root_ / "csv", fresh(), options); });
  };
  EXPECT_THAT(fault_of({{"C", video}}),
              HasSubstr("fits no clip; expected CLIP=VIDEO (one is 'A')"));
  EXPECT_THAT(fault_of({{"", video}, {"A", video}}), HasSubstr("fits no clip"));
  EXPECT_EQ(fault_of({{"", video}}), "no error");
  write_file(root_ / "csv/B.csv", "frame,x,y,w,h\n0,10,20,30,40\n");
  EXPECT_THAT(fault_of({{"", video}}), HasSubstr("fits no clip"));
  EXPECT_EQ(fault_of({{"B", video}}), "no error");
}

TEST_F(Made, AVideoIsForTheOnlyClipOfItsName) {
  for (const char* part : {"train", "val"}) {
    fs::create_directories(root_ / "mot" / part / "a/gt");
    write_file(root_ / "mot" / part / "a/gt/gt.txt", "1,1,10,20,30,40,1,1,1\n");
  }
  ImportOptions options;
  options.format = exchange::Format::kMot;
  options.videos["a"] = LabelledSet(set()).clip("sky-across-b737").media;
  EXPECT_THAT(test_support::error_of([&] { import_set(root_ / "mot", fresh(), options); }),
              HasSubstr("fits 2 clips"));
}

// ffmpeg numbers the pictures of a video from 1.
TEST_F(Made, ThePictureNumberedOneIsTheFirstFrameOfTheVideoThatIsGiven) {
  const fs::path out = fresh();
  const fs::path voc = fresh();
  fs::create_directories(voc / "Annotations");
  for (const char* name : {"a_000001.xml", "a_000002.xml"})
    write_file(voc / "Annotations" / name,
               "<annotation><object><name>plane</name><bndbox><xmin>1</xmin><ymin>1</ymin>"
               "<xmax>9</xmax><ymax>9</ymax></bndbox></object></annotation>");
  std::string warnings;
  ImportOptions options;
  options.format = exchange::Format::kVoc;
  options.videos[""] = LabelledSet(set()).clip("sky-across-b737").media;
  options.warn = [&](const std::string& warning) { warnings += warning + "\n"; };
  import_set(voc, out, options);
  const exchange::Clip clip = exchange::read_labels(out / "sequences" / "a" / "labels.jsonl");
  ASSERT_EQ(clip.frames.size(), 2u);
  EXPECT_EQ(clip.frames[0].frame, 0);
  EXPECT_EQ(clip.frames[1].frame, 1);
  EXPECT_THAT(warnings,
              HasSubstr("its frame 0, counted from 0, is taken for the picture a_000001 of a"));
}

// COCO numbers the pictures of every second frame one after another.
TEST_F(Made, LabelsOfEverySecondFrameAreThoseOfTheFramesOfTheVideoAtTheirTimes) {
  const std::string name = "sky-across-b737";
  const exchange::Clip whole = LabelledSet(set()).clip(name);
  ExportOptions options;
  options.images = Images::kNone;
  options.split = Split::kNone;
  options.every = 2;
  const auto imported = [&](exchange::Format format, const char* labels) {
    options.format = format;
    const fs::path out = fresh(), again = fresh();
    export_set(set(), out, options);
    ImportOptions back;
    back.format = format;
    back.videos[name] = whole.media;
    std::string warnings;
    back.warn = [&](const std::string& warning) { warnings += warning + "\n"; };
    import_set(out / labels, again, back);
    return std::pair(LabelledSet(again).clip(name), warnings);
  };
  const auto [coco, said] = imported(exchange::Format::kCoco, "annotations/instances_all.json");
  ASSERT_EQ(coco.frames.size(), whole.frames.size() / 2);
  for (std::size_t i = 0; i < coco.frames.size(); ++i) {
    EXPECT_EQ(coco.frames[i].frame, whole.frames[2 * i].frame);
    EXPECT_EQ(coco.frames[i].labels.at(0).box_px, whole.frames[2 * i].labels.at(0).box_px);
  }
  EXPECT_EQ(coco.frame_rate_hz, whole.frame_rate_hz);
  EXPECT_THAT(said, HasSubstr("they are taken for those of the frames at their times"));
  EXPECT_THAT(imported(exchange::Format::kMot, "").second,
              HasSubstr("their frame k is taken for its frame k"));
}

// A folder whose name begins with a dot is none of the set's sequences.
TEST_F(Made, ANameThatBeginsWithADotIsImportedInSight) {
  const fs::path out = fresh();
  ImportOptions options;
  options.format = exchange::Format::kCsv;
  const fs::path csv = root_ / ".q.csv";
  write_file(csv, "frame,x,y,w,h\n0,10,20,30,40\n");
  import_set(csv, out, options);
  EXPECT_THAT(LabelledSet(out).names(), ElementsAre("-q"));
}

// What a format cannot hold, and what the set lacks, is said before a folder is made.
TEST_F(Made, AnErrorLeavesNoFolder) {
  const auto refused = [&](const fs::path& from, exchange::Format format, const char* words) {
    const fs::path out = fresh();
    ExportOptions options;
    options.format = format;
    try {
      export_set(from, out, options);
      ADD_FAILURE() << words;
    } catch (const Error& error) {
      EXPECT_THAT(error.message(), HasSubstr(words));
    }
    EXPECT_FALSE(fs::exists(out)) << words;
  };
  refused(
      set(), exchange::Format::kCsv, "csv is a format that is read alone; expected one of coco");
  refused(set(), exchange::Format::kEvision, "read alone");
  const fs::path csv = root_ / "sizeless.csv";
  write_file(csv, "frame,x,y,w,h\n0,10,20,30,40\n5,11.5,20,30,40\n");
  const fs::path imported = fresh();
  ImportOptions import_options;
  import_options.format = exchange::Format::kCsv;
  import_set(csv, imported, import_options);
  refused(imported, exchange::Format::kYolo, "has no known size");
  for (const exchange::Format format : kAll) {
    if (format == exchange::Format::kYolo) continue;
    refused(imported, format, "no video to take pictures from");
  }
}

TEST_F(Made, DeepVerificationFindsAFrameThatIsNotWhatItsTruthSays) {
  build::VerifyOptions options;
  options.deep_every = 1;
  const build::VerifyResult sound = build::verify(set(), options);
  EXPECT_THAT(sound.faults, ElementsAre());
  EXPECT_EQ(sound.recomposed, 32);
  // One visible box is moved by one pixel.
  const fs::path copy = changed("sky-across-c172", [](nlohmann::ordered_json& intruder) {
    intruder["visible_box_px"][0] = intruder["visible_box_px"][0].get<int>() + 1;
  });
  EXPECT_THAT(build::verify(copy, options).faults,
              testing::Contains(HasSubstr("has another truth when it is computed again")));
}

TEST_F(Made, VerificationMeasuresTheContrastInTheVideo) {
  EXPECT_THAT(build::verify(set(), {}).faults, ElementsAre());
  const fs::path copy = changed("sky-across-c172", [](nlohmann::ordered_json& intruder) {
    intruder["contrast_to_noise"] = 1.01 * intruder["contrast_to_noise"].get<double>();
  });
  const auto faults = build::verify(copy, {}).faults;
  EXPECT_THAT(faults, ElementsAre(HasSubstr("a contrast to noise of ")));
}

// pycocotools' evaluation passes over iscrowd, VOC's over difficult, TrackEval over a 0 in the
// seventh column; which boxes these are follows from truth.jsonl read by itself.
TEST_F(Made, WhatIsTooFaintOrTooSmallCountsNeitherWay) {
  std::vector<double> contrasts;
  for (const auto& entry : fs::recursive_directory_iterator(set())) {
    if (entry.path().filename() != "truth.jsonl") continue;
    std::istringstream lines(read_file(entry.path()));
    for (std::string line; std::getline(lines, line);) {
      const auto frame = nlohmann::json::parse(line);
      for (const auto& one : frame["intruders"])
        if (!one["covered_box_px"].is_null()) contrasts.push_back(one["contrast_to_noise"]);
    }
  }
  std::sort(contrasts.begin(), contrasts.end());
  ExportOptions options;
  options.split = Split::kNone;
  options.images = Images::kNone;
  options.min_contrast = contrasts[contrasts.size() / 3];
  const auto below = std::count_if(contrasts.begin(), contrasts.end(), [&](double value) {
    return value < options.min_contrast;
  });
  ASSERT_GT(below, 0);
  const fs::path coco = fresh();
  EXPECT_EQ(export_set(set(), coco, options).faint, below);
  std::ptrdiff_t crowds = 0;
  const auto json = nlohmann::json::parse(read_file(coco / "annotations/instances_all.json"));
  for (const auto& one : json["annotations"]) {
    EXPECT_EQ(one["iscrowd"] == 1, one["contrast_to_noise"] < options.min_contrast);
    crowds += one["iscrowd"] == 1 ? 1 : 0;
  }
  EXPECT_EQ(crowds, below);
  EXPECT_EQ(json["annotations"].size(), contrasts.size());
  options.drop_faint = true;
  const fs::path dropped = fresh();
  export_set(set(), dropped, options);
  EXPECT_EQ(
      nlohmann::json::parse(read_file(dropped / "annotations/instances_all.json"))["annotations"]
          .size(),
      contrasts.size() - static_cast<std::size_t>(below));
  options = {.format = exchange::Format::kYolo, .images = Images::kNone, .split = Split::kNone};
  options.min_size_px = 1e6;
  const fs::path yolo = fresh();
  EXPECT_EQ(export_set(set(), yolo, options).faint, std::ssize(contrasts));
  for (const auto& entry : fs::recursive_directory_iterator(yolo / "labels")) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(fs::file_size(entry.path()), 0) << entry.path();
  }
}

TEST_F(Made, VerificationFindsAnIntruderThatGeometrySeesAndTruthDoesNot) {
  EXPECT_GT(build::verify(set(), {}).in_view, 16);
  const fs::path copy = changed("sky-across-c172", [](nlohmann::ordered_json& intruder) {
    intruder["state"] = "outside";
    intruder["visible_box_px"] = nullptr;
    intruder["covered_box_px"] = nullptr;
    intruder["covered_area_px"] = nullptr;
    intruder["contrast_to_noise"] = nullptr;
  });
  const build::VerifyResult result = build::verify(copy, {});
  EXPECT_EQ(result.in_view_without_box, 1);
  EXPECT_THAT(result.faults,
              ElementsAre(HasSubstr("in view by its position, and without a box"),
                          HasSubstr("a mask, and not visible")));
}

}  // namespace
}  // namespace airtruth::labelled
