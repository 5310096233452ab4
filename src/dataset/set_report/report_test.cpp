// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/report.h"

#include <airtruth/labels.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dataset/build/build.h"
#include "foundation/base/files.h"
#include "support/small_catalogue.h"
#include "support/temporary_folder.h"
#include "support/video_folder.h"

namespace airtruth::set_report {
namespace {

// The data that the page holds: the JSON object whose keys begin with "frames".
nlohmann::json data_of_page_of(const fs::path& set, const fs::path& page, std::size_t max_shown) {
  ReportOptions options;
  options.overwrite = true;
  options.max_shown = max_shown;
  write_report(set, page, options);
  const std::string text = read_file(page);
  const auto begin = text.find("{\"frames\":");
  const auto end = text.find("</script>", begin);
  return nlohmann::json::parse(text.substr(begin, end - begin));
}

class Report : public testing::Test {
 protected:
  Report() {
    build::build_set(
        catalogue::parse_catalogue(test_support::kCatalogue, "c.toml"), root_ / "set", {});
  }

  nlohmann::json data_of_page(std::size_t max_shown) const {
    return data_of_page_of(root_ / "set", root_ / "page.html", max_shown);
  }

  test_support::TemporaryFolder temporary_;
  fs::path root_ = temporary_.path();
};

TEST_F(Report, OfALargeSetShowsSomeSequencesAndCountsAll) {
  const nlohmann::json whole = data_of_page(4);
  const nlohmann::json part = data_of_page(2);
  EXPECT_EQ(whole.at("sequences").size(), 4u);
  ASSERT_EQ(part.at("sequences").size(), 2u);
  // The first and the last by name.
  EXPECT_EQ(part.at("sequences")[0], whole.at("sequences")[0]);
  EXPECT_EQ(part.at("sequences")[1].at("name"), "sky-across-c172");
  for (const auto& data : {whole, part}) {
    EXPECT_EQ(data.at("count"), 4);
    EXPECT_EQ(data.at("frames"), 4 * 8);
  }
  for (const char* counted : {"frames_with_intruder", "negative_sequences", "classes", "centres"})
    EXPECT_EQ(part.at(counted), whole.at(counted)) << counted;
  for (const char* plot : {"range_m", "size_px", "azimuth_deg", "states"})
    EXPECT_EQ(part.at("plots").at(plot), whole.at("plots").at(plot)) << plot;
}

// An aircraft that is seen without covering a pixel has no label, and is no box of the counts.
TEST_F(Report, WhatHasNoLabelIsNoBox) {
  const nlohmann::json before = data_of_page(1);
  const fs::path truth = root_ / "set" / "sequences" / "sky-across-c172" / "truth.jsonl";
  std::string text = read_file(truth);
  const std::size_t box = text.find("\"covered_box_px\":[");
  ASSERT_NE(box, std::string::npos);
  text.replace(box, text.find(']', box) + 1 - box, "\"covered_box_px\":null");
  const std::size_t area = text.find("\"covered_area_px\":", text.rfind('\n', box) + 1);
  text.replace(area, text.find_first_of(",}", area) - area, "\"covered_area_px\":null");
  write_file(truth, text);
  const nlohmann::json after = data_of_page(1);
  const auto boxes = [](const nlohmann::json& data, const char* plot) {
    double sum = 0;
    for (const nlohmann::json& y : data.at("plots").at(plot).at("series").at(0).at("y"))
      sum += y.get<double>();
    return sum;
  };
  for (const char* plot : {"classes", "range_m", "size_px", "azimuth_deg"})
    EXPECT_EQ(boxes(after, plot), boxes(before, plot) - 1) << plot;
  EXPECT_EQ(after.at("frames_with_intruder"), before.at("frames_with_intruder"));
}

// The page has the series of at most 120 of the 241 frames, of which the second is none.
class OfALongClip : public video::Video {};
TEST_F(OfALongClip, TheNearestRangeIsThatOfAllFrames) {
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=10 -c:v libx264 clip.mp4");
  exchange::Clip clip{.name = "a", .media = "../../../clip.mp4", .width = 64, .height = 48};
  clip.frame_rate_hz = 25;
  for (std::int64_t k = 0; k <= 240; ++k) {
    exchange::Label label{.track = 1, .category = "738", .box_px = {20, 20, 10, 6}};
    label.range_m = 900;
    if (k == 1) label.box_px.width = 30;
    if (k == 1) label.range_m = 100;
    clip.frames.push_back({k, {}, {label}});
    // A bird is nearer and larger, and no aircraft.
    exchange::Label bird{.track = 2, .category = "bird", .box_px = {2, 2, 40, 30}};
    bird.object_class = "bird";
    bird.range_m = 5;
    clip.frames.back().labels.push_back(bird);
  }
  const fs::path folder = folder_ / "set" / "sequences" / "a";
  fs::create_directories(folder);
  write_file(folder / "labels.jsonl", exchange::labels_jsonl(clip));
  write_file(folder / "sequence.json",
             R"({"format": "airtruth labelled clip 1", "name": "a", "frames": 241, "labels": 482,
                 "categories": ["738", "bird"], "distractors": ["bird"]})");
  const nlohmann::json a =
      data_of_page_of(folder_ / "set", folder_ / "page.html", 1).at("sequences").at(0);
  EXPECT_LE(a.at("intruders").at(0).at("range_m").size(), 120u);
  EXPECT_EQ(a.at("range_m"), nlohmann::json({100, 900}));
  EXPECT_EQ(a.at("size_px"), nlohmann::json({10, 30}));
  EXPECT_EQ(a.at("stills").at(a.at("poster").get<std::size_t>()).at("frame"), 1);
}

}  // namespace
}  // namespace airtruth::set_report
