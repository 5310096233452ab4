// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "labels/exchange/exchange.h"
#include "labels/exchange/test_folder.h"

namespace airtruth::exchange {
namespace {

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

}  // namespace
}  // namespace airtruth::exchange
