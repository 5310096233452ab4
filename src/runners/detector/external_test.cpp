// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "runners/detector/detector.h"
#include "runners/detector/protocol.h"
#include "support/process_end.h"

namespace airtruth::detector {
namespace {

using testing::HasSubstr;

TEST(Protocol, HelloSaysWhatAProgramTakes) {
  const Hello plain = hello_of(R"({"hello":{"protocol":1}})");
  EXPECT_EQ(plain.samples, SampleOrder::kRgb);
  EXPECT_EQ(plain.frames, FramesBy::kPipe);
  const Hello other =
      hello_of(R"({"hello":{"protocol":1,"samples":"gray","frames":"shared_memory","new":1}})");
  EXPECT_EQ(other.samples, SampleOrder::kGray);
  EXPECT_EQ(other.frames, FramesBy::kSharedMemory);
  for (const char* bad : {"",
                          "{",
                          "[]",
                          "{}",
                          R"({"hello":1})",
                          R"({"hello":{}})",
                          R"({"hello":{"protocol":2}})",
                          R"({"hello":{"protocol":"1"}})",
                          R"({"hello":{"protocol":1,"samples":"bgr"}})",
                          R"({"hello":{"protocol":1,"frames":7}})"})
    EXPECT_THROW(hello_of(bad), process::Failure) << bad;
}

TEST(Protocol, AnswersAreDetections) {
  EXPECT_TRUE(detections_of(R"({"frame":4,"detections":[]})", 4).empty());
  const auto found = detections_of(R"({"frame":0,"detections":[{"box":[1,2.5,3,4],"score":0.5},)"
                                   R"({"box":[-1,0,9,9],"score":-2,"category":"bird","track":7}]})",
                                   0);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0], (results::Detection{{1, 2.5, 3, 4}, 0.5, "aircraft", {}}));
  EXPECT_EQ(found[1], (results::Detection{{-1, 0, 9, 9}, -2, "bird", 7}));
}

std::string fault_in(const std::string& line) {
  try {
    detections_of(line, 3);
    return "";
  } catch (const process::Failure& error) {
    return error.what();
  }
}

TEST(Protocol, AnswersThatAreNoneSayWhy) {
  EXPECT_THAT(fault_in(R"({"frame":2,"detections":[]})"),
              HasSubstr("out of order: frame '2', when asked for frame 3"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":[{"box":[1,1,1,1],"score":NaN}]})"),
              HasSubstr("NaN"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":[{"box":[1,1,1,1e999],"score":1}]})"),
              HasSubstr("no JSON"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":[{"box":[1,1,1,1]}]})"), HasSubstr("score"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":[{"box":[1,1,1],"score":1}]})"),
              HasSubstr("expected"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":[7]})"), HasSubstr("expected"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":7})"), HasSubstr("no list"));
  EXPECT_THAT(fault_in(R"({"frame":3})"), HasSubstr("no list"));
  EXPECT_THAT(fault_in(R"({"frame":"3","detections":[]})"), HasSubstr("expected"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":[{"box":[1,1,1,1],"score":1,"track":-4}]})"),
              HasSubstr("track"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":[{"box":[1,1,1,1],"score":1,"track":4},)"
                       R"({"box":[9,9,1,1],"score":1,"track":4}]})"),
              HasSubstr("track 4 twice for frame 3"));
  EXPECT_THAT(fault_in(R"({"frame":3,"detections":[{"box":[1,1,1,1],"score":1,"category":4}]})"),
              HasSubstr("category"));
  EXPECT_THAT(fault_in("{\"frame\":3,\x01\xff"), HasSubstr("no JSON object"));
  // A million lists in each other are refused without recursion to that depth.
  EXPECT_THAT(fault_in("{\"frame\":3,\"detections\":" + std::string(1'000'000, '[') +
                       std::string(1'000'000, ']') + "}"),
              HasSubstr("nested deeper"));
}

image::Picture picture() {
  image::Picture made = image::make_picture(32, 24, {image::Chroma::kNone});
  for (int y = 0; y < 24; ++y) std::fill_n(made.planes[0].row(y), 32, std::uint8_t{128});
  return made;
}

// Programs in shell, as short as they can be: what `to_frame` says is done at every frame.
std::string answering(const std::string& to_frame) {
  return R"(echo '{"hello":{"protocol":1,"samples":"gray","frames":"shared_memory"}}'; )"
         R"(while read -r line; do case "$line" in '{"frame":'*) )"
         R"(k=${line#*:}; k=${k%%,*}; )" +
         to_frame + R"(;; '{"quit"'*) exit 0;; esac; done)";
}
constexpr const char* kNothing = R"(echo "{\"frame\":$k,\"detections\":[]}")";

std::unique_ptr<Detector> external(const std::string& command, double seconds = 20) {
  return make_external(command, {seconds, seconds, {}});
}

SequenceInput sequence() {
  return {"one", 32, 24, 30, lens::pinhole_from_vertical_fov(40, {32, 24})};
}

// What three frames with a program end in; "" for a good end.
std::string fault_of(const std::string& command, double seconds = 20) {
  const image::Picture one = picture();
  try {
    const auto detector = external(command, seconds);
    detector->begin(sequence());
    for (int k = 0; k < 3; ++k) detector->detect({k, k / 30.0, &one, k == 0, CameraTurn{}});
    return "";
  } catch (const process::Failure& error) {
    return error.what();
  }
}
std::string hang_of(const std::string& command) { return fault_of(command, 0.3); }

TEST(External, AnswersFrameByFrame) {
  const image::Picture one = picture();
  const auto detector = external(answering(
      R"(echo chatter; echo "{\"frame\":$k,\"detections\":[{\"box\":[$k,2,3,4],\"score\":1}]}")"));
  for (int sequences = 0; sequences < 2; ++sequences) {
    detector->begin(sequence());
    for (int k = 0; k < 3; ++k) {
      const auto found = detector->detect({k, k / 30.0, &one, {}});
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(found[0].box_px, (Box{double(k), 2, 3, 4}));
    }
    EXPECT_THAT(detector->log(), HasSubstr("chatter"));
  }
}

TEST(External, GetsItsFramesInSharedMemory) {
  EXPECT_EQ(fault_of(R"(echo '{"hello":{"protocol":1,"frames":"shared_memory"}}'; read -r line
      f=${line#*shared_memory\":\"}; f=${f%%\"*}; [ $(wc -c < "$f") = 2304 ] || exit 5
      while read -r line; do case "$line" in
        '{"frame":'*) head -c 3 "$f" >&2; k=${line#*:}; k=${k%%,*}; echo "{\"frame\":$k,\"detections\":[]}";;
        *) exit 0;; esac; done)"),
            "");
}

TEST(External, ThatShortensTheFileOfItsFramesGetsTheNextOneWhole) {
  EXPECT_EQ(
      fault_of(
          R"(echo '{"hello":{"protocol":1,"samples":"gray","frames":"shared_memory"}}'; read -r line
      f=${line#*shared_memory\":\"}; f=${f%%\"*}
      while read -r line; do case "$line" in
        '{"frame":'*) [ $(wc -c < "$f") = 768 ] || exit 5; : > "$f"
          k=${line#*:}; k=${k%%,*}; echo "{\"frame\":$k,\"detections\":[]}";;
        *) exit 0;; esac; done)"),
      "");
}

// The program answers with the first of the samples as a place.
TEST(External, GreyOfRedGreenAndBlueIsTheirLuma) {
  image::Picture colour =
      image::make_picture(32, 24, {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  const std::uint8_t green_blue_red[] = {100, 50, 200};
  for (std::size_t p = 0; p < 3; ++p)
    for (int y = 0; y < 24; ++y) std::fill_n(colour.planes[p].row(y), 32, green_blue_red[p]);
  const auto detector = external(
      R"(echo '{"hello":{"protocol":1,"samples":"gray","frames":"shared_memory"}}'; read -r line
      f=${line#*shared_memory\":\"}; f=${f%%\"*}; [ $(wc -c < "$f") = 768 ] || exit 5
      while read -r line; do case "$line" in
        '{"frame":'*) v=$(od -An -tu1 -N1 "$f" | tr -d ' ')
          echo "{\"frame\":0,\"detections\":[{\"box\":[$v,2,3,4],\"score\":1}]}";;
        *) exit 0;; esac; done)");
  detector->begin(sequence());
  const auto found = detector->detect({0, 0, &colour, true, CameraTurn{}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].box_px.x, 124);  // 0.299 * 200 + 0.587 * 100 + 0.114 * 50
}

TEST(External, ThatGoesWrongSaysHow) {
  EXPECT_THAT(fault_of("no_such_detector_4711"), HasSubstr("not found"));
  EXPECT_THAT(fault_of("exit 0"), HasSubstr("ended with status 0"));
  EXPECT_THAT(fault_of(R"(echo '{"hi":1}'; cat)"), HasSubstr("first; expected"));
  EXPECT_THAT(fault_of(answering("echo out of memory >&2; kill -SEGV $$")),
              HasSubstr("signal 11; its last words: out of memory"));
  EXPECT_THAT(fault_of(answering(R"(echo "{\"frame\":7,\"detections\":[]}")")),
              HasSubstr("out of order: frame '7', when asked for frame 0"));
  EXPECT_THAT(fault_of(answering(std::string(kNothing) + "; " + kNothing + "; sleep 0.2")),
              testing::AnyOf(HasSubstr("before it was asked"), HasSubstr("out of order")));
  EXPECT_THAT(fault_of(answering(R"(echo "{\"frame\":$k,\"detections\":[{\"box\":[1,1,1,1],)"
                                 R"(\"score\":NaN}]}")")),
              HasSubstr("NaN"));
  EXPECT_THAT(fault_of(answering("exec >&-; sleep 60")), HasSubstr("closed its output"));
}

TEST(External, ThatHangsMissesItsDeadline) {
  EXPECT_THAT(hang_of("exec sleep 60 # says no hello"), HasSubstr("in time"));
  EXPECT_THAT(hang_of(answering("exec sleep 60")), HasSubstr("in time"));
  EXPECT_THAT(hang_of(answering("exec yes nonsense")), HasSubstr("in time"));
}

// A frame is larger than the buffer of a pipe, and nobody reads it.
TEST(External, ThatReadsNothingMissesItsDeadline) {
  const auto detector = external(R"(echo '{"hello":{"protocol":1}}'; exec sleep 60)", 0.3);
  const image::Picture large = image::make_picture(640, 480, {});
  detector->begin({"one", 640, 480, 30, lens::pinhole_from_vertical_fov(40, {640, 480})});
  EXPECT_THROW(detector->detect({0, 0, &large, {}}), process::Failure);
}

TEST(External, ThatFloodsTakesNeitherMemoryNorTime) {
  EXPECT_EQ(fault_of(answering(std::string("head -c 3000000 /dev/zero | tr '\\0' 'x'; echo; ") +
                               kNothing)),
            "");
  EXPECT_THAT(fault_of(answering(R"(exec yes '{"frame":0,"detections":[]}')")),
              testing::AnyOf(HasSubstr("before it was asked"), HasSubstr("out of order")));
}

TEST(External, LeavesNoProcessBehind) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("airtruth_external_" + std::to_string(::getpid()));
  {
    const auto detector = external("trap '' TERM; (trap '' TERM; sleep 300) & echo $! > " +
                                   file.string() + "; " + answering(kNothing));
    detector->begin(sequence());
  }
  pid_t grandchild = 0;
  std::ifstream(file) >> grandchild;
  std::filesystem::remove(file);
  ASSERT_GT(grandchild, 0);
  EXPECT_TRUE(test_support::ends(grandchild));
}

TEST(External, EndsAWaitWhenStopped) {
  std::stop_source stop;
  const auto detector = make_external(answering("exec sleep 60"), {20, 20, stop.get_token()});
  const image::Picture one = picture();
  detector->begin(sequence());
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop.request_stop();
  });
  EXPECT_THROW(detector->detect({0, 0, &one, {}}), Interrupted);
  later.join();
}

}  // namespace
}  // namespace airtruth::detector
