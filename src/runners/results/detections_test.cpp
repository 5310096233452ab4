// SPDX-License-Identifier: Apache-2.0
#include "runners/results/detections.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "runners/results/results_folder.h"

namespace airtruth::results {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Results : public testing::Test {
 protected:
  Results() : folder_(fs::path(testing::TempDir()) / ("detections_" + name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Results() override { fs::remove_all(folder_); }

  static std::string name() {
    return testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  void put(const std::string& file, const std::string& text) const {
    fs::create_directories((folder_ / file).parent_path());
    write_file(folder_ / file, text);
  }
  // Where a result of the box {1, 1, 1, 1} with each of the `keys` is in a set, as "sequence frame
  // category", with what is warned of; or the error.
  std::vector<std::string> read(const std::vector<std::string>& keys,
                                const std::vector<ExpectedSequence>& set) const {
    std::string text;
    for (const std::string& key : keys)
      text += (text.empty() ? "[{" : ",\n{") + key + R"(,"bbox":[1,1,1,1],"score":1})";
    put("r.json", text + "]");
    std::vector<std::string> found;
    try {
      const auto note = [&](const std::string& warning) { found.push_back(warning); };
      for (const auto& sequence : read_detections(folder_ / "r.json", set, note))
        for (std::size_t i = 0; i < sequence.frames.size(); ++i)
          for (const Detection& d : sequence.frames[i])
            found.push_back(sequence.name + " " + std::to_string(i) + " " + d.category);
    } catch (const Error& error) {
      found.emplace_back(error.what());
    }
    return found;
  }
  // The message for what a file holds.
  std::string fault(const std::string& file, const std::string& text) const {
    put(file, text);
    std::string message = "no error";
    try {
      read_detections(file.ends_with(".json") ? folder_ / file : folder_, kSet);
    } catch (const Error& error) {
      message = error.what();
    }
    fs::remove(folder_ / file);
    return message;
  }

  const std::vector<ExpectedSequence> kSet = {{"a", 640, 480, 3}, {"b", 320, 240, 2}};
  fs::path folder_;
};

SequenceDetections one_of_each_kind() {
  SequenceDetections d{"b", 320, 240, {{}, {}}, {0.25, 0.5}};
  d.frames[1] = {{{10.5, -2, 20, 8.125}, 7.5, "aircraft", 4}, {{0, 0, 3, 3}, -1e-9, "bird", {}}};
  return d;
}

TEST_F(Results, OfASequenceAreReadAsTheyWereWritten) {
  const SequenceDetections written = one_of_each_kind();
  write_sequence(folder_, written);
  ASSERT_TRUE(has_sequence(folder_, "b"));
  EXPECT_FALSE(has_sequence(folder_, "a"));
  const SequenceDetections read = read_sequence(folder_, "b");
  EXPECT_EQ(read.frames, written.frames);
  EXPECT_EQ(read.seconds, written.seconds);
  EXPECT_EQ(read.width, 320);
  EXPECT_EQ(read_file(folder_ / "b.txt"),
            "2,4,11.5,-1,20,8.125,7.5,-1,-1,-1\n2,-1,1,1,3,3,-1e-09,-1,-1,-1\n");
}

// Rounding carries a box over the edge of the picture, or not, before it is judged.
TEST_F(Results, AreReadAsTheyWereJudged) {
  const auto is_possible = [](const Box& box) {
    return !fault_of({as_written(box), 1, "aircraft", {}}, 320, 240);
  };
  EXPECT_FALSE(is_possible({319.9997, 20, 8, 6}));
  EXPECT_FALSE(is_possible({10, -5.9996, 8, 6}));
  SequenceDetections written{"b", 320, 240, {{}}, {}};
  for (const Box& box :
       {Box{319.9993, 20, 8, 6}, Box{0.1, -5.9994, 1. / 3, 6}, Box{7, 7, 1e-9, 2}}) {
    EXPECT_TRUE(is_possible(box)) << box.x;
    written.frames[0].push_back({as_written(box), 1, "aircraft", {}});
  }
  write_sequence(folder_, written);
  EXPECT_EQ(read_sequence(folder_, "b").frames, written.frames);
  EXPECT_EQ(as_written({0, 0, -1, 0}), (Box{0, 0, -1, 0}));
}

TEST_F(Results, OfAFolderOfOursAreThoseOfItsSequences) {
  put("detector.json", "{}");
  write_sequence(folder_, one_of_each_kind());
  put("a.txt", "half written");  // without a.json it is not there yet
  const auto all = read_detections(folder_, kSet);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].name, "b");
}

// Image ids count the frames of the set through: a has 1 to 3, b has 4 and 5.
TEST_F(Results, InCocosFormatHaveTheImageIdsOfTheSet) {
  write_sequence(folder_, one_of_each_kind());
  write_coco_results(folder_ / "detections.json", folder_, kSet);
  EXPECT_EQ(read_file(folder_ / "detections.json"),
            R"([{"image_id":5,"category_id":1,"bbox":[10.5,-2.0,20.0,8.125],"score":7.5,)"
            R"("track_id":4,"category_name":"aircraft"},)"
            "\n"
            R"({"image_id":5,"category_id":2,"bbox":[0.0,0.0,3.0,3.0],"score":-1e-09,)"
            R"("category_name":"bird"}])"
            "\n");
  const auto all = read_detections(folder_ / "detections.json", kSet);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].frames, std::vector<std::vector<Detection>>(3));
  EXPECT_EQ(all[1].frames, one_of_each_kind().frames);
}

TEST_F(Results, OfCocoMayNameTheirImages) {
  put("r.json", R"([ {"image_id": "images/all/b/000001.png", "bbox": [1, 2, 3, 4], "score": 1},
   {"file_name": "a/000000", "category_id": 3, "bbox": [1, 2, 3, 4], "score": 2, "track_id": -1} ])");
  const auto all = read_detections(folder_, kSet);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].frames[1].at(0), (Detection{{1, 2, 3, 4}, 1, "aircraft", {}}));
  EXPECT_EQ(all[0].frames[0].at(0), (Detection{{1, 2, 3, 4}, 2, "3", {}}));
}

// Category 1 of the set is a bird.
TEST_F(Results, InCocosFormatHaveTheCategoryIdsThatTheSetStates) {
  std::vector<ExpectedSequence> set = kSet;
  for (ExpectedSequence& one : set) one.category_ids = {{1, "bird"}, {2, "airplane"}};
  set[0].categories = {"airplane"};
  const SequenceDetections written{"b", 320, 240, {{{{1, 1, 9, 9}, 1, "aircraft", {}}}, {}}, {}};
  write_sequence(folder_, written);
  write_coco_results(folder_ / "detections.json", folder_, set);
  EXPECT_THAT(read_file(folder_ / "detections.json"),
              HasSubstr(R"("image_id":4,"category_id":2,)"));
  EXPECT_EQ(read_detections(folder_ / "detections.json", set)[1].frames, written.frames);
}

// Two files that number their images from 1 make one set.
TEST_F(Results, InCocosFormatHaveImageIdsOfTheirOwnWhereTheSetStatesOneTwice) {
  std::vector<ExpectedSequence> set = kSet;
  set[0].pictures = {"train/p.jpg", "train/q.jpg", "train/r.jpg"};
  set[0].image_ids = {1, 2, 3};
  set[1].pictures = {"val/p.jpg", "val/q.jpg"};
  set[1].image_ids = {1, 2};
  const SequenceDetections written = one_of_each_kind();
  write_sequence(folder_, written);
  write_coco_results(folder_ / "detections.json", folder_, set);
  EXPECT_THAT(read_file(folder_ / "detections.json"), HasSubstr(R"("image_id":5)"));
  EXPECT_EQ(read_detections(folder_ / "detections.json", set)[1].frames, written.frames);
  EXPECT_THAT(read({R"("image_id":4)", R"("image_id":1)"}, set),
              ElementsAre("a 0 aircraft", "b 0 aircraft"));
  EXPECT_THAT(read({R"("image_id":2)", R"("image_id":1)"}, set),
              ElementsAre(HasSubstr("image_id 2 is an image of 'a' and of 'b'")));
}

// The pictures 2 to 5 of a video, which an export of their places names 0 to 3.
TEST_F(Results, OfCocoNameAllTheirImagesByOneRule) {
  ExpectedSequence clip{"clip", 64, 48, 4};
  for (const char* number : {"2", "3", "4", "5"})
    clip.pictures.push_back(std::string("clip/00000") + number + ".jpg");
  const auto images = [&](const std::vector<std::string>& numbers) {
    std::vector<std::string> keys;
    for (const std::string& number : numbers)
      keys.push_back(R"("file_name":"clip/00000)" + number + R"(.jpg")");
    return read(keys, {clip});
  };
  EXPECT_THAT(images({"0", "3"}), ElementsAre("clip 0 aircraft", "clip 3 aircraft"));
  EXPECT_THAT(images({"3", "5"}), ElementsAre("clip 1 aircraft", "clip 3 aircraft"));
  EXPECT_THAT(
      images({"3"}),
      ElementsAre(HasSubstr("by the names of the set's pictures or by places"), "clip 1 aircraft"));
  EXPECT_THAT(images({"0", "5"}), ElementsAre(HasSubstr("no image 'clip/000000.jpg'")));
  EXPECT_THAT(read({R"("image_id":2)", R"("image_id":3)"}, {clip}),
              ElementsAre(HasSubstr("counted over the set or by the numbers in the names"),
                          "clip 1 aircraft",
                          "clip 2 aircraft"));
}

// An export has {1: bird, 2: c172}, and one of one class {1: aircraft, 2: bird}.
TEST_F(Results, OfCocoHaveTheCategoryIdsOfAnExport) {
  ExpectedSequence clip{"clip", 64, 48, 1};
  clip.categories = {"bird", "c172"};
  clip.distractors = {"bird"};
  const std::string one = R"("image_id":1,"category_id":1)",
                    two = R"("image_id":1,"category_id":2)";
  EXPECT_THAT(read({one}, {clip}), ElementsAre("clip 0 aircraft"));
  EXPECT_THAT(read({two}, {clip}), ElementsAre("clip 0 c172"));
  EXPECT_THAT(read({one, two}, {clip}), ElementsAre(HasSubstr("'bird' in an export of the set")));
  EXPECT_THAT(read({R"("image_id":1,"category_id":5)"}, {clip}),
              ElementsAre(HasSubstr("category_id 5 is none of the set's"), "clip 0 5"));
  clip.categories = {"bird", "b737", "c172"};
  EXPECT_THAT(read({two, R"("image_id":1,"category_id":3)"}, {clip}),
              ElementsAre("clip 0 bird", "clip 0 c172"));
  clip.category_ids = {{1, "bird"}, {2, "c172"}};
  EXPECT_THAT(read({one}, {clip}),
              ElementsAre(HasSubstr("category_id 1 is 'bird' in the set"), "clip 0 bird"));
}

TEST_F(Results, OfMotChallengeHaveThreePlaces) {
  for (const char* file : {"b.txt", "data/b.txt", "b/det/det.txt"}) {
    put(file, "1,-1,1,1,10,10,0.5\n");
    const auto all = read_detections(folder_, kSet);
    ASSERT_EQ(all.size(), 1U) << file;
    EXPECT_EQ(all[0].frames.size(), 2U);
    EXPECT_EQ(all[0].frames[0].at(0), (Detection{{0, 0, 10, 10}, 0.5, "aircraft", {}}));
    fs::remove(folder_ / file);
  }
  put("b.txt", "");
  put("data/b.txt", "");
  EXPECT_THROW(read_detections(folder_, kSet), Error);
}

TEST_F(Results, OfAnotherSizeOrLengthAreNotOfThisSet) {
  put("detector.json", "{}");
  SequenceDetections d = one_of_each_kind();
  d.frames.emplace_back();
  d.seconds.clear();
  write_sequence(folder_, d);
  EXPECT_THROW(read_detections(folder_, kSet), Error);
  d = one_of_each_kind();
  d.width = 330;
  write_sequence(folder_, d);
  EXPECT_THROW(read_detections(folder_, kSet), Error);
}

TEST_F(Results, ThatAreNoneSayWhere) {
  EXPECT_THAT(fault("a.txt", "1,-1,1,1,9,9,0.5\n1,-1,641.5,1,9,9,0.5\n"),
              HasSubstr("a.txt:2: the box 640.5,0 9x9 lies outside its image of 640x480"));
  EXPECT_THAT(fault("a.txt", "1,-1,1,1,9,9,nan\n"), HasSubstr("a.txt:1: a score is nan"));
  EXPECT_THAT(fault("a.txt", "1,-1,1,1,0,9,1\n"), HasSubstr("has no area"));
  EXPECT_THAT(fault("a.txt", "4,-1,1,1,9,9,1\n"), HasSubstr("frame is number 4 of 'a'"));
  EXPECT_THAT(fault("a.txt", "1e12,-1,1,1,9,9,1\n"), HasSubstr("a.txt:1: "));
  EXPECT_THAT(fault("a.txt", "0,-1,1,1,9,9,1\n"), HasSubstr("no whole number from 1"));
  EXPECT_THAT(fault("a.txt", "1,7,1,1,9,9,1\n1,7,3,3,9,9,1\n"),
              HasSubstr("a.txt:2: track 7 is in frame 1 of 'a' twice"));
  EXPECT_THAT(fault("a.txt", "1,7,1\n"), HasSubstr("has 3 columns"));
  EXPECT_THAT(fault("c.txt", ""), HasSubstr("has no sequence of that name"));
  EXPECT_THAT(fault("x.md", ""), HasSubstr("holds no results"));
}

TEST_F(Results, OfCocoThatAreNoneSayWhere) {
  const auto one = [&](const std::string& entry) { return fault("r.json", "[\n" + entry + "]"); };
  EXPECT_THAT(one(R"({"image_id": 6, "bbox": [1,1,1,1], "score": 1})"),
              HasSubstr("r.json:2: image_id is 6; the set has 5 images with ids from 1 to 5"));
  EXPECT_THAT(one(R"({"image_id": "bb/000000.jpg", "bbox": [1,1,1,1], "score": 1})"),
              HasSubstr("r.json:2: the set has no image 'bb/000000.jpg'"));
  EXPECT_THAT(one(R"({"image_id": "b/000002.jpg", "bbox": [1,1,1,1], "score": 1})"),
              HasSubstr("'b' has the frames 0 to 1"));
  EXPECT_THAT(one(R"({"image_id": 1, "bbox": [1,1,1,1], "score": NaN})"), HasSubstr("holds NaN"));
  EXPECT_THAT(one(R"({"image_id": 1, "bbox": [1,1,1,1]})"), HasSubstr("r.json:2: "));
  EXPECT_THAT(one(R"({"image_id": 1, "bbox": [1,1,1], "score": 1})"), HasSubstr("bbox"));
  EXPECT_THAT(one(R"({"image_id": 1, "bbox": [999,1,1,1], "score": 1})"), HasSubstr("outside"));
  EXPECT_THAT(fault("r.json", "[{\"image_id\": 1,"), HasSubstr("not whole"));
  EXPECT_THAT(fault("r.json", "{\"images\": []}"),
              HasSubstr("has no annotations; expected COCO results"));
  EXPECT_THAT(fault("r.json", "[] []"), HasSubstr("goes on after the list"));
  EXPECT_THAT(fault("r.json", "[[[[[["), HasSubstr("not whole"));
  EXPECT_THAT(fault("r.json", ""), HasSubstr("no list of detections"));
}

// The ids of images and categories are the file's own.
TEST_F(Results, InAWholeCocoFileHaveItsIds) {
  put("r.json", R"({"info": {"annotations": "no } list, \"really\""},
   "annotations": [
     {"id": 1, "image_id": 70, "category_id": 5, "bbox": [1, 2, 3, 4], "score": 0.5},
     {"id": 2, "image_id": 80, "category_id": 9, "bbox": [5, 6, 7, 8], "score": 0.25}],
   "categories": [{"id": 5, "name": "aircraft"}, {"id": 9, "name": "bird"}],
   "images": [{"id": 70, "file_name": "images/all/b/000001.jpg"},
              {"id": 80, "file_name": "a/000002.jpg"}, {"id": 90, "file_name": "elsewhere.jpg"}]})");
  const auto all = read_detections(folder_, kSet);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].frames[1].at(0), (Detection{{1, 2, 3, 4}, 0.5, "aircraft", {}}));
  EXPECT_EQ(all[0].frames[2].at(0), (Detection{{5, 6, 7, 8}, 0.25, "bird", {}}));
  // Without images the ids are those of the set.
  put("r.json", R"({"annotations": [{"image_id": 4, "bbox": [1, 2, 3, 4], "score": 1}]})");
  EXPECT_EQ(read_detections(folder_, kSet)[1].frames[0].size(), 1U);
}

TEST_F(Results, OfAWholeCocoFileThatAreNoneSayWhere) {
  const auto one = [&](const std::string& annotation, const std::string& rest = "") {
    return fault("r.json", "{\"annotations\": [\n" + annotation + "]" + rest + "}");
  };
  EXPECT_THAT(one(R"({"image_id": 1, "bbox": [1,1,1,1]})"),
              HasSubstr("r.json:2: is an annotation without a score; expected COCO results"));
  EXPECT_THAT(one(R"({"image_id": 1, "bbox": [1,1,1,1], "score": 1})",
                  R"(,"images":[])"
                  R"(,"images":[])"),
              HasSubstr("has 'images' twice"));
  const std::string images = R"(,"images":[{"id": 7, "file_name": "c/000000.jpg"}])";
  EXPECT_THAT(one(R"({"image_id": 1, "bbox": [1,1,1,1], "score": 1})", images),
              HasSubstr("r.json:2: image_id is 1, which the file's images do not have"));
  EXPECT_THAT(one(R"({"image_id": 7, "bbox": [1,1,1,1], "score": 1})", images),
              HasSubstr("r.json:2: the set has no image 'c/000000.jpg'"));
  EXPECT_THAT(one(R"({"image_id": 1, "category_id": 2, "bbox": [1,1,1,1], "score": 1})",
                  R"(,"categories":[{"id": 1, "name": "x"}])"),
              HasSubstr("category_id is 2, which the file's categories do not have"));
  EXPECT_THAT(fault("r.json", "{\"annotations\": ["), HasSubstr("not whole"));
  EXPECT_THAT(fault("r.json", "{\"annotations\": {}}"), HasSubstr("no list of annotations"));
  EXPECT_THAT(fault("r.json", "{\"annotations\": []} x"), HasSubstr("goes on after the object"));
  EXPECT_THAT(fault("r.json", "{annotations: []}"), HasSubstr("expected a key"));
}

TEST(Fault, IsWhatNoPictureCanHold) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(fault_of({{-5, -5, 10, 10}, 1}, 640, 480));
  EXPECT_FALSE(fault_of({{9999, 0, 10, 10}, 1}, 0, 0));  // the size is unknown
  EXPECT_TRUE(fault_of({{-10, 0, 10, 10}, 1}, 640, 480));
  EXPECT_TRUE(fault_of({{nan, 0, 10, 10}, 1}, 640, 480));
  EXPECT_TRUE(fault_of({{0, 0, 10, 10}, nan}, 640, 480));
}

}  // namespace
}  // namespace airtruth::results
