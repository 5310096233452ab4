// SPDX-License-Identifier: Apache-2.0
#include "runners/results/trajectories.h"

#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "runners/results/vot_regions.h"

namespace airtruth::results {
namespace {

using evaluation::Mark;
using evaluation::Trajectory;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ResultsFolder {
 public:
  ResultsFolder()
      : path_(fs::temp_directory_path() /
              ("airtruth_results_" + std::to_string(std::random_device{}()))) {}
  ~ResultsFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }
  fs::path file(const std::string& name, std::string_view text) const {
    fs::create_directories((path_ / name).parent_path());
    write_file(path_ / name, text);
    return path_ / name;
  }

 private:
  fs::path path_;
};

std::string bytes_from_hex(std::string_view hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
  return bytes;
}

// What vot-toolkit 0.8.0 writes (region/io.py, write_trajectory_binary) for the marks and regions
// of kText, which is what it writes for the same as text.
constexpr std::string_view kBinaryHex =
    "010006000000"
    "0001000000"
    "01000028410000a2410000f04100002042"
    "0203000000803f0000004000003041000080400000c04000001841"
    "036400fdff040003000500"
    "01000200010004000400"
    "0002000000"
    "0000000000";
constexpr std::string_view kText =
    "1\n10.5,20.25,30.0,40.0\n1.0,2.0,11.0,4.0,6.0,9.5\nm100,-3,4,3,1,2,1,4,4\n2\n0\n";

const exchange::Clip& clip() {
  static const exchange::Clip six = [] {
    exchange::Clip made;
    made.name = "a";
    for (int i = 0; i < 6; ++i) made.frames.push_back({i, {}, {}});
    return made;
  }();
  return six;
}

// The same with an object, at (10 + frame, 20).
exchange::Clip with_truth() {
  exchange::Clip made = clip();
  for (exchange::LabelledFrame& frame : made.frames) {
    exchange::Label label;
    label.box_px = {10. + static_cast<double>(frame.frame), 20, 8, 6};
    frame.labels.push_back(label);
  }
  return made;
}

std::string fault_of(const ResultsFolder& folder) {
  try {
    read_results(folder.path(), clip(), 0);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(Times, KeepTheNanosecond) {
  EXPECT_EQ(text_of(std::vector<double>{1.234e-6, 0.5, 12.000000001}),
            "0.000001234\n0.500000000\n12.000000001\n");
  const ResultsFolder folder;
  folder.file("a.txt", "1,2,3,4\n1,2,3,4\n1,2,3,4\n1,2,3,4\n1,2,3,4\n1,2,3,4\n");
  // With the six decimals of older results, and with nine.
  folder.file("a_time.txt", "0.000001\n0.000001\n0.000000\n0.000001234\n0.5\n2\n");
  EXPECT_THAT(read_results(folder.path(), clip(), 0).one_pass->seconds,
              ElementsAre(1e-6, 1e-6, 0, 1.234e-6, 0.5, 2));
}

// VOT's toolkit writes an empty line for a frame without a time.
TEST(Times, BlankLinesAreFramesWithoutATime) {
  const ResultsFolder folder;
  folder.file("a.txt", kText);
  const std::string times = "a_time.txt";
  folder.file(times, "0.5\n\n0.25\n\n\n\n");
  EXPECT_THAT(read_results(folder.path(), clip(), 0).one_pass->seconds,
              ElementsAre(0.5, 0, 0.25, 0, 0, 0));
  folder.file(times, "\n\n\n\n\n0.125");
  EXPECT_THAT(read_results(folder.path(), clip(), 0).one_pass->seconds,
              ElementsAre(0, 0, 0, 0, 0, 0.125));
  // Six times among blank lines belong to the six frames.
  folder.file(times, "1\n2\n3\n\n4\n5\n6\n\n");
  EXPECT_THAT(read_results(folder.path(), clip(), 0).one_pass->seconds,
              ElementsAre(1, 2, 3, 4, 5, 6));
  folder.file(times, "1\n\n");
  EXPECT_THAT(fault_of(folder), HasSubstr("has 2 lines; its results have 6"));
  // Those of VOT's runs are checked.
  const ResultsFolder vot;
  vot.file("baseline/a/a_001.txt", kText);
  vot.file("baseline/a/a_001_time.value", "0.5\n\n0.25\n\n\n\n");
  EXPECT_EQ(fault_of(vot), "");
  vot.file("baseline/a/a_001_time.value", "1\n\n");
  EXPECT_THAT(fault_of(vot), HasSubstr("a_001_time.value: has 2 lines; its results have 6"));
}

TEST(Repetitions, OfGot10kAreAllReadWithAColumnOfTimesEach) {
  const ResultsFolder folder;
  const auto write = [&](const std::string& name, const std::string& line) {
    std::string text;
    for (int i = 0; i < 6; ++i) text += line + "\n";
    folder.file("a/" + name, text);
  };
  write("a_002.txt", "2,1,9,9");
  write("a_009.txt", "9,1,9,9");
  write("a_time.txt", "0.5,0.25");
  write("a_00000000.txt", "7,1,9,9");  // named as a run from an anchor is
  const TrackerResults read = read_results(folder.path(), clip(), 0);
  ASSERT_EQ(read.further_passes.size(), 1U);
  EXPECT_EQ(read.one_pass->frames.at(5).box, (Box{2, 1, 9, 9}));
  EXPECT_EQ(read.one_pass->seconds, std::vector<double>(6, 0.5));
  EXPECT_EQ(read.further_passes[0].frames.at(5).box, (Box{9, 1, 9, 9}));
  EXPECT_EQ(read.further_passes[0].seconds, std::vector<double>(6, 0.25));
  folder.file("a.txt", "1,2,3,4\n1,2,3,4\n1,2,3,4\n1,2,3,4\n1,2,3,4\n1,2,3,4\n");
  EXPECT_TRUE(read_results(folder.path(), clip(), 0).further_passes.empty());
}

void expect_the_six(const Trajectory& run) {
  ASSERT_EQ(run.size(), 6u);
  EXPECT_EQ(run[0].mark, Mark::kBegun);
  EXPECT_EQ(run[1].box, (Box{10.5, 20.25, 30, 40}));
  EXPECT_EQ(run[2].box, (Box{1, 2, 10, 7.5}));
  // .XX.
  // XXXX
  // ....
  EXPECT_EQ(run[3].box, (Box{100, -3, 4, 2}));
  EXPECT_EQ(run[4].mark, Mark::kFailed);
  EXPECT_EQ(run[5].mark, Mark::kUnknown);
}

TEST(VotRuns, AreReadAsTextAndAsBinary) {
  const ResultsFolder text;
  text.file("baseline/a/a_001.txt", kText);
  expect_the_six(read_results(text.path(), clip(), 0).restart.at(0));
  const ResultsFolder binary;
  binary.file("baseline/a/a_001.bin", bytes_from_hex(kBinaryHex));
  binary.file("baseline/a/a_001_time.value", "0.5\n\n\n\n\n\n");
  const TrackerResults found = read_results(binary.path(), clip(), 0);
  expect_the_six(found.restart.at(0));
  EXPECT_THAT(tracked_sequences_in(binary.path()), ElementsAre("a"));
  // Of a run in both forms the toolkit reads the text.
  binary.file("baseline/a/a_001.txt", "1\n0\n0\n0\n0\n0\n");
  EXPECT_EQ(read_results(binary.path(), clip(), 0).restart.size(), 1u);
  EXPECT_FALSE(read_results(binary.path(), clip(), 0).restart.at(0)[1].box);
  // From an anchor: the same six, backward from frame 5.
  const ResultsFolder anchored;
  anchored.file("multistart/a/a_00000005.bin", bytes_from_hex(kBinaryHex));
  expect_the_six(read_results(anchored.path(), clip(), 0).multistart.at(0).frames);
}

TEST(VotRuns, ANanIsTheMarkZeroAndNoAreaIsAnAnswer) {
  const ResultsFolder folder;
  const std::string lines = "1\nnan,nan,nan,nan\n1,2,0,4\n1,2,nan,4\n1,2,-3,4\n1,1,nan,2,3,3\n";
  folder.file("restart/a/a_001.txt", lines);
  const Trajectory run = read_results(folder.path(), clip(), 0).restart.at(0);
  std::vector<Mark> marks;
  for (const evaluation::VotFrame& frame : run) {
    marks.push_back(frame.mark);
    EXPECT_FALSE(frame.box);
  }
  EXPECT_THAT(marks,
              ElementsAre(Mark::kBegun,
                          Mark::kUnknown,
                          Mark::kAnswer,
                          Mark::kUnknown,
                          Mark::kAnswer,
                          Mark::kUnknown));
  // In one pass there are no marks: all of these are frames without an answer.
  folder.file("a.txt", lines);
  const TrackerResults one_pass = read_results(folder.path(), clip(), 0);
  for (const evaluation::VotFrame& frame : one_pass.one_pass->frames)
    EXPECT_EQ(frame.mark, Mark::kAnswer);
  // A side below 0 is a fault, which is told; one of 0 says that there is no answer.
  EXPECT_EQ(one_pass.negative_boxes, 2);
  EXPECT_EQ(to_string(one_pass.first_negative), (folder.path() / "a.txt").string() + ":5");
}

// The rectangle of kBinaryHex with a width of -30; its place has no line.
TEST(VotRuns, ASideBelow0IsToldOfABinaryFileToo) {
  const ResultsFolder folder;
  std::string bytes = bytes_from_hex(kBinaryHex);
  bytes.at(6 + 5 + 1 + 8 + 3) = '\xc1';  // the sign of the third float32 of the second region
  const fs::path file = folder.path() / "baseline/a/a_001.bin";
  folder.file("baseline/a/a_001.bin", bytes);
  const TrackerResults found = read_results(folder.path(), clip(), 0);
  EXPECT_FALSE(found.restart.at(0).at(1).box);
  EXPECT_EQ(found.negative_boxes, 1);
  EXPECT_EQ(to_string(found.first_negative), file.string());
}

TEST(MotTracks, ASideBelow0IsTold) {
  const ResultsFolder folder;
  folder.file("a.txt", "1,1,5,5,9,9,1\n2,1,5,5,-9,9,1\n3,1,5,5,0,9,1\n");
  const TrackerResults results = read_results(folder.path(), clip(), 0);
  EXPECT_EQ(results.negative_boxes, 1);
  EXPECT_EQ(to_string(results.first_negative), (folder.path() / "a.txt").string() + ":2");
}

std::string lines_of(int count, const std::function<std::string(int)>& line) {
  std::string text;
  for (int i = 0; i < count; ++i) text += line(i) + "\n";
  return text;
}

TEST(MotTracks, HaveAnyNumberOfColumnsFromSevenOn) {
  const std::string columns = ",1,1,0.5,-1,-1,-1,-1";
  for (const std::size_t length : {2, 4, 8, 11, 14}) {
    const ResultsFolder folder;
    folder.file("a.txt", lines_of(6, [&](int i) {
                  return std::to_string(i + 1) + ",1," + std::to_string(11 + i) + ",21,8,6" +
                         columns.substr(0, length);
                }));
    const TrackerResults read = read_results(folder.path(), with_truth(), 0);
    for (int i = 0; i < 6; ++i)
      EXPECT_EQ(read.one_pass->frames.at(static_cast<std::size_t>(i)).box, (Box{10. + i, 20, 8, 6}))
          << length;
    EXPECT_EQ(read.doubt, "");
  }
}

TEST(MotTracks, AreSortedByFrameOrById) {
  for (const char* text :
       {"1,4,11,21,8,6,1,1\n1,2,99,99,8,6,1,1\n2,4,12,21,8,6,1,1\n",
        "1,2,99,99,8,6,1,1\n2,2,99,99,8,6,1,1\n1,4,11,21,8,6,1,1\n2,4,12,21,8,6,1,1\n"}) {
    const ResultsFolder folder;
    folder.file("a.txt", text);
    const TrackerResults read = read_results(folder.path(), with_truth(), 0);
    EXPECT_EQ(read.one_pass->frames.at(1).box, (Box{11, 20, 8, 6})) << text;
  }
}

// The part from the fourth labelled frame on of a video of which every fifth frame is labelled.
TEST(MotTracks, CountTheLabelledFramesOfTheSequence) {
  exchange::Clip part = with_truth();
  for (exchange::LabelledFrame& frame : part.frames) frame.frame = 40 + 5 * frame.frame;
  for (const char* columns : {",1", ",1,1"}) {
    const ResultsFolder folder;
    folder.file("a.txt", lines_of(6, [&](int i) {
                  return std::to_string(4 + i) + ",1," + std::to_string(11 + i) + ",21,8,6" +
                         columns;
                }));
    const TrackerResults read = read_results(folder.path(), part, 0, 3);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_EQ(read.one_pass->frames.at(i).box, results::box_of(part.frames[i])) << columns;
    EXPECT_EQ(read.doubt, "");
  }
}

TEST(Polygons, OfWholeNumbersAreToldFromMotChallengeByAllLines) {
  // Four and five corners; the first line alone could be of frame 50 and id 30.
  for (const char* corners : {",58,30,58,36,50,36", ",58,30,58,36,54,39,50,36"}) {
    const ResultsFolder folder;
    folder.file("a.txt",
                lines_of(6, [&](int i) { return std::to_string(50 - i) + ",30" + corners; }));
    const TrackerResults read = read_results(folder.path(), clip(), 0);
    EXPECT_EQ(read.one_pass->frames.at(3).box->x, 47) << corners;
    EXPECT_EQ(read.doubt, "");
  }
}

TEST(Polygons, AreReadWhereTheClipHasNoSuchFramesWhichIsTold) {
  const ResultsFolder folder;
  const auto read_from = [&](int first, int step) {
    folder.file("a.txt", lines_of(6, [&](int i) {
                  return std::to_string(first + step * i) + ",30,99,30,99,36,50,36";
                }));
    return read_results(folder.path(), clip(), 0);
  };
  const TrackerResults polygons = read_from(50, 2);
  EXPECT_EQ(polygons.one_pass->frames.at(3).box->x, 50);
  EXPECT_THAT(polygons.doubt,
              HasSubstr("a.txt: fits MOTChallenge and polygons alike, and is read "
                        "as polygons"));
  EXPECT_EQ(read_from(1, 1).doubt, "");
  // A line for each frame of the clip, of two tracks in some and of none in others.
  folder.file("a.txt",
              "1,1,5,5,9,9,1,1\n1,2,5,5,9,9,1,1\n2,1,5,5,9,9,1,1\n3,1,5,5,9,9,1,1\n"
              "5,1,5,5,9,9,1,1\n6,1,5,5,9,9,1,1\n");
  EXPECT_THAT(read_results(folder.path(), clip(), 0).doubt, HasSubstr("read as MOTChallenge"));
}

TEST(VotRuns, ThatAreNoneSaySo) {
  const ResultsFolder beyond;
  beyond.file("multistart/a/a_00000006.txt", "1\n0\n0\n0\n0\n0\n0\n");
  EXPECT_THAT(fault_of(beyond), HasSubstr("begins at frame 6; a has 6 frames"));
  const std::string sound = bytes_from_hex(kBinaryHex);
  for (std::size_t length = 0; length < sound.size(); ++length) {
    const ResultsFolder folder;
    folder.file("baseline/a/a_001.bin", sound.substr(0, length));
    EXPECT_THAT(fault_of(folder), HasSubstr("a_001.bin: ends within a region (byte ")) << length;
  }
  const auto fault = [&](std::size_t at, char value) {
    const ResultsFolder folder;
    std::string bytes = sound;
    bytes.at(at) = value;
    folder.file("baseline/a/a_001.bin", bytes);
    return fault_of(folder);
  };
  EXPECT_THAT(fault(0, 2), HasSubstr("has version 2"));
  EXPECT_THAT(fault(2, 5), HasSubstr("has more than its 5 regions"));
  EXPECT_THAT(fault(5, 127), HasSubstr("ends within a region"));
  EXPECT_THAT(fault(6, 9), HasSubstr("has a region of type 9"));
  EXPECT_THAT(fault(66, 99), HasSubstr("runs are longer than the mask"));
  for (const char* mask : {"m1,2,3", "m0,0,2,2,5", "m0,0,2,2,1,-1", "m0,0,1e9,1e9,4", "mx"}) {
    const ResultsFolder folder;
    folder.file("baseline/a/a_001.txt", std::string("1\n") + mask + "\n0\n0\n0\n0\n");
    EXPECT_THAT(fault_of(folder), HasSubstr("a_001.txt:2")) << mask;
  }
}

}  // namespace
}  // namespace airtruth::results
