// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/evision.h"

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core/persistence.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/error_of.h"
#include "support/shared_folder.h"
#include "support/temporary_folder.h"

namespace airtruth::annotation {
namespace {

// Two frames in the form of the published files, and one in which the intruder is not in the world.
constexpr std::string_view kForm = R"(<?xml version="1.0"?>
<opencv_storage>
<frame_1>
  <CameraPos_m>
    <x>-1.6666666269302368e+000</x>
    <y>0.</y>
    <z>-1.5050000000000000e+002</z></CameraPos_m>
  <IntruderPos_m>
    <x>7.0031494140625000e+002</x>
    <y>-900.</y>
    <z>1.2500000000000000e-001</z></IntruderPos_m>
  <Distance_m>1.1598188139822830e+003</Distance_m>
  <IntruderRect_pix>
    <x>11</x>
    <y>340</y>
    <width>30</width>
    <height>9</height></IntruderRect_pix></frame_1>
<frame_2>
  <CameraPos_m>
    <x>1.</x>
    <y>0.</y>
    <z>-150.</z></CameraPos_m>
  <IntruderRect_pix>
    <x>0</x>
    <y>0</y>
    <width>0</width>
    <height>0</height></IntruderRect_pix></frame_2>
</opencv_storage>
)";

std::string evision_xml(const std::vector<std::optional<EvisionFrame>>& frames,
                        const std::vector<Vector3>& camera_ned_m) {
  const test_support::TemporaryFolder folder;
  EvisionWriter writer(folder / "a.xml");
  for (std::size_t i = 0; i < frames.size(); ++i) writer.add(frames[i], camera_ned_m[i]);
  writer.finish();
  return read_file(folder / "a.xml");
}

Evision form() { return parse_evision(kForm, "a.xml"); }

std::string message_of(const std::string& text) {
  return test_support::error_of([&] { parse_evision(text, "a.xml"); });
}

std::string with(const std::string& from, const std::string& to) {
  std::string text(kForm);
  return message_of(text.replace(text.find(from), from.size(), to));
}

TEST(Evision, ReadsThePublishedForm) {
  const Evision evision = form();
  ASSERT_EQ(evision.frames.size(), 2u);
  ASSERT_TRUE(evision.frames[0]);
  EXPECT_EQ(evision.frames[0]->number, 1);
  EXPECT_EQ(evision.frames[0]->intruder_ned_m, Vector3(700.31494140625, -900, 0.125));
  EXPECT_EQ(evision.frames[0]->distance_m, 1159.8188139822830);
  EXPECT_EQ(evision.frames[0]->rect_px, (PixelBox{11, 340, 30, 9}));
  EXPECT_FALSE(evision.frames[1]);
  EXPECT_EQ(evision.camera_ned_m[1], Vector3(1, 0, -150));
}

TEST(Evision, WritesThePublishedFormByteForByte) {
  const Evision evision = form();
  EXPECT_EQ(evision_xml(evision.frames, evision.camera_ned_m), kForm);
}

TEST(Evision, OpenCvReadsWhatIsWritten) {
  const Evision evision = form();
  const cv::FileStorage storage(evision_xml(evision.frames, evision.camera_ned_m),
                                cv::FileStorage::READ | cv::FileStorage::MEMORY);
  const cv::FileNode frame = storage["frame_1"];
  EXPECT_EQ(static_cast<double>(frame["CameraPos_m"]["x"]), evision.camera_ned_m[0].x());
  EXPECT_EQ(static_cast<double>(frame["IntruderPos_m"]["y"]), -900.0);
  EXPECT_EQ(static_cast<double>(frame["Distance_m"]), 1159.8188139822830);
  EXPECT_EQ(static_cast<int>(frame["IntruderRect_pix"]["width"]), 30);
  EXPECT_TRUE(storage["frame_2"]["IntruderPos_m"].empty());
}

TEST(Evision, ReadsWhatOpenCvWrites) {
  cv::FileStorage storage("a.xml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "frame_3"
          << "{";
  storage << "CameraPos_m"
          << "{"
          << "x" << 0.1 << "y" << -2.0 << "z" << 7e13 << "}";
  storage << "IntruderPos_m"
          << "{"
          << "x" << 1e-300 << "y" << 5.0 << "z" << -0.25 << "}";
  storage << "Distance_m" << 3.5;
  storage << "IntruderRect_pix"
          << "{"
          << "x" << -3 << "y" << 4 << "width" << 5 << "height" << 6 << "}";
  storage << "}";
  const Evision evision = parse_evision(storage.releaseAndGetString(), "a.xml");
  ASSERT_EQ(evision.frames.size(), 1u);
  EXPECT_EQ(evision.frames[0]->number, 3);
  EXPECT_EQ(evision.camera_ned_m[0], Vector3(0.1, -2, 7e13));
  EXPECT_EQ(evision.frames[0]->intruder_ned_m, Vector3(1e-300, 5, -0.25));
  EXPECT_EQ(evision.frames[0]->rect_px, (PixelBox{-3, 4, 5, 6}));
}

TEST(Evision, NumbersOfAnySizeReadBackTheSame) {
  EvisionFrame frame;
  frame.intruder_ned_m = {1.0 / 3.0, -7e13, 1e-300};
  frame.distance_m = 2147483648.0;
  const std::vector<Vector3> camera{{1e300, -2147483647, 0.5}};
  const Evision again = parse_evision(evision_xml({frame}, camera), "a.xml");
  EXPECT_EQ(again.frames[0]->intruder_ned_m, frame.intruder_ned_m);
  EXPECT_EQ(again.frames[0]->distance_m, frame.distance_m);
  EXPECT_EQ(again.camera_ned_m, camera);
}

TEST(Evision, FaultsHaveTheirLine) {
  EXPECT_EQ(message_of(""), "a.xml:1: is not XML: No document element found");
  EXPECT_EQ(message_of("<a/>"),
            "a.xml: has no <opencv_storage>; expected an annotation of OpenCV's FileStorage");
  EXPECT_EQ(with("<x>11</x>", "<x>eleven</x>"), "a.xml:14: <x> holds no finite number");
  EXPECT_EQ(with("<x>11</x>", "<x>1.5</x>"), "a.xml:14: <x> holds no whole number of pixels");
  EXPECT_EQ(with("<y>0.</y>", "<y>.Nan</y>"), "a.xml:6: <y> holds no finite number");
  EXPECT_EQ(with("<width>30", "<width>-30"), "a.xml:13: <IntruderRect_pix> has a negative size");
  EXPECT_EQ(with("    <y>-900.</y>\n", ""), "a.xml:8: <IntruderPos_m> has no <y>");
  EXPECT_EQ(with("  <Distance_m>1.1598188139822830e+003</Distance_m>\n", ""),
            "a.xml:3: <frame_1> has no <Distance_m>");
  EXPECT_EQ(message_of("<opencv_storage>\n<frame_0/></opencv_storage>"),
            "a.xml:2: found <frame_0>; expected <frame_1>, <frame_2>, ...");
  EXPECT_EQ(message_of("<opencv_storage>\n<other/></opencv_storage>"),
            "a.xml:2: found <other>; expected <frame_1>, <frame_2>, ...");
}

TEST(Evision, AFileCutAnywhereIsAnErrorNeverACrash) {
  for (std::size_t size = 0; size < kForm.size() - 2; ++size)
    EXPECT_NE(message_of(std::string(kForm.substr(0, size))), "no error") << size;
}

TEST(Evision, DeeplyNestedXmlDoesNotExhaustTheStack) {
  std::string deep;
  for (int i = 0; i < 200'000; ++i) deep += "<a>";
  EXPECT_NE(message_of(deep), "no error");
}

// True where the lines differ at most by one in the 17th digit of one number. Where a value lies
// exactly between two numbers of 17 digits, the published files contain sometimes the upper and
// sometimes the lower one. Both parse to the same double.
bool differs_in_rounding(const std::string& a, const std::string& b) {
  const std::size_t exponent = a.find('e', a.find('.'));
  if (a.size() != b.size() || exponent == std::string::npos) return false;
  std::string c = a;
  c[exponent - 1] = b[exponent - 1];
  const auto number = [](const std::string& line) {
    return std::stod(line.substr(line.find('>') + 1));
  };
  return c == b && std::abs(a[exponent - 1] - b[exponent - 1]) == 1 && number(a) == number(b);
}

// Reads and writes every published file. Each line must stay the same, except for the rounding of
// exact halves.
TEST(Evision, PublishedFilesComeBackButForTheRoundingOfHalves) {
  const char* const shared = test_support::shared_folder();
  if (!shared) GTEST_SKIP() << "AIRTRUTH_SHARED is not set: the published annotations are not here";
  int files = 0;
  std::size_t lines = 0;
  std::size_t rounded = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(shared) / "evision/groundtruth")) {
    const std::string published_text = read_file(entry.path());
    const Evision evision = parse_evision(published_text, entry.path());
    std::istringstream published(published_text);
    std::istringstream written(evision_xml(evision.frames, evision.camera_ned_m));
    std::string a;
    std::string b;
    while (std::getline(published, a)) {
      ++lines;
      ASSERT_TRUE(std::getline(written, b)) << entry.path();
      if (a == b) continue;
      ++rounded;
      EXPECT_TRUE(differs_in_rounding(a, b)) << entry.path() << ": " << a << " against " << b;
    }
    EXPECT_FALSE(std::getline(written, b)) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 12);
  EXPECT_LT(static_cast<double>(rounded), 0.03 * static_cast<double>(lines));
}

}  // namespace
}  // namespace airtruth::annotation
