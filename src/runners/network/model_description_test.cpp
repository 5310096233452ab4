// SPDX-License-Identifier: Apache-2.0
#include "runners/network/model_description.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/error_of.h"

namespace airtruth::network {
namespace {

using testing::HasSubstr;

const std::string kWhole = R"({
  "format": "airtruth detector model 1",
  "input": {"layout": "bgr", "mean": [1, 2, 3], "scale": 0.5, "fit": "tiles", "width": 640,
            "height": 480, "overlap_px": 64},
  "output": {"kind": "heat_map", "heat": "hm", "offset": "reg", "size": "wh",
             "activation": "sigmoid", "size_unit": "cell"},
  "classes": ["aircraft", "bird"],
  "score_threshold": 0.2,
  "confident_score": 0.6,
  "nms_iou": 0.4
})";

ModelDescription read(const std::string& text) {
  const fs::path file =
      fs::temp_directory_path() / ("airtruth_description_" + std::to_string(::getpid()) + ".json");
  write_file(file, text);
  struct Remove {
    fs::path file;
    ~Remove() { fs::remove(file); }
  } const remove{file};
  return read_description(file);
}

std::string fault(const std::string& from, const std::string& to) {
  std::string text = kWhole;
  text.replace(text.find(from), from.size(), to);
  return test_support::error_of([&] { read(text); });
}

TEST(ModelDescription, IsReadWhole) {
  const ModelDescription description = read(kWhole);
  EXPECT_EQ(description.input.layout, NetworkInput::Layout::kBgr);
  EXPECT_EQ(description.input.mean, (std::array<float, 3>{1, 2, 3}));
  EXPECT_EQ(description.input.scale, (std::array<float, 3>{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(description.input.fit, NetworkInput::Fit::kTiles);
  EXPECT_EQ(description.input.width, 640);
  EXPECT_EQ(description.input.height, 480);
  EXPECT_EQ(description.input.overlap_px, 64);
  const auto& output = std::get<HeatMapOutput>(description.output);
  EXPECT_TRUE(output.needs_sigmoid);
  EXPECT_FALSE(output.is_size_log);
  EXPECT_TRUE(output.is_size_in_cells);
  EXPECT_EQ(output_names(description), (std::vector<std::string>{"hm", "reg", "wh"}));
  EXPECT_EQ(description.classes, (std::vector<std::string>{"aircraft", "bird"}));
  EXPECT_EQ(description.score_threshold, 0.2);
  EXPECT_EQ(description.confident_score, 0.6);
  EXPECT_EQ(description.nms_iou, 0.4);
  EXPECT_EQ(description_path("x/a.onnx"), fs::path("x/a.json"));
}

TEST(ModelDescription, FaultsAreNamedAtTheirLine) {
  EXPECT_THAT(
      fault("score_threshold", "score_treshold"),
      HasSubstr(".json:8: unknown key \"score_treshold\"; did you mean \"score_threshold\"?"));
  EXPECT_THAT(fault("overlap_px", "overlap"),
              HasSubstr(".json:4: input: unknown key \"overlap\"; expected one of"));
  EXPECT_THAT(fault("\"tiles\"", "\"tile\""),
              HasSubstr("input.fit is \"tile\"; expected one of frame, tiles, letterbox"));
  EXPECT_THAT(fault("\"tiles\"", "\"frame\""),
              HasSubstr("input: unknown key \"width\"; expected one of layout"));
  EXPECT_THAT(fault("heat_map", "yolov9000"),
              HasSubstr("output.kind is \"yolov9000\"; expected one of heat_map, yolov5, yolov8"));
  EXPECT_THAT(fault("[1, 2, 3]", "[1, 2]"), HasSubstr("input.mean"));
  EXPECT_THAT(fault("64}", "400}"), HasSubstr("input.overlap_px is 400"));
  EXPECT_THAT(fault("model 1", "model 2"), HasSubstr("format is"));
  EXPECT_THAT(fault("\"format\": \"airtruth detector model 1\",", ""),
              HasSubstr("has no format; expected \"airtruth detector model 1\""));
  EXPECT_THAT(fault("\"fit\": \"tiles\",", ""),
              HasSubstr("input: has no fit; expected one of frame, tiles, letterbox"));
  EXPECT_THAT(fault("[\"aircraft\", \"bird\"]", "[]"),
              HasSubstr("classes is a list; expected 1 to 1000 names"));
  EXPECT_THAT(fault("0.6", "0.1"), HasSubstr("confident_score is 0.1; expected a number from 0.2"));
  EXPECT_THAT(fault("0.4", "2"), HasSubstr("nms_iou is 2"));
  EXPECT_THAT(fault("{", "["), HasSubstr(".json"));
}

}  // namespace
}  // namespace airtruth::network
