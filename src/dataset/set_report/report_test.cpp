// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dataset/build/build.h"
#include "foundation/base/files.h"
#include "support/small_catalogue.h"
#include "support/temporary_folder.h"

namespace airtruth::set_report {
namespace {

class Report : public testing::Test {
 protected:
  Report() {
    build::build_set(
        catalogue::parse_catalogue(test_support::kCatalogue, "c.toml"), root_ / "set", {});
  }

  // The data that the page holds: the JSON object whose keys begin with "frames".
  nlohmann::json data_of_page(std::size_t max_shown) const {
    ReportOptions options;
    options.overwrite = true;
    options.max_shown = max_shown;
    write_report(root_ / "set", root_ / "page.html", options);
    const std::string page = read_file(root_ / "page.html");
    const auto begin = page.find("{\"frames\":");
    const auto end = page.find("</script>", begin);
    return nlohmann::json::parse(page.substr(begin, end - begin));
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

}  // namespace
}  // namespace airtruth::set_report
