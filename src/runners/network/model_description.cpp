// SPDX-License-Identifier: Apache-2.0
#include "runners/network/model_description.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/json/json_object.h"

namespace airtruth::network {
namespace {

constexpr const char* kFormat = "airtruth detector model 1";
constexpr std::size_t kMostBytes = std::size_t{1} << 20;  // of the JSON; one takes a few hundred
// Bounds for a stranger's description, far above what detectors have.
constexpr std::size_t kMostClasses = 1000;
constexpr int kMostPx = 8192;  // of an input's side

[[noreturn]] void missing(const JsonObject& object,
                          const std::string& key,
                          const std::string& expected) {
  object.fail(fmt::format("has no {}; expected {}", key, expected));
}

// The value of one of a few words.
template <typename Value>
Value word(const JsonObject& object,
           const std::string& key,
           std::initializer_list<std::pair<const char*, Value>> words,
           std::optional<Value> otherwise = std::nullopt) {
  if (otherwise && !object.has(key)) return *otherwise;
  const std::string text = object.maybe_text(key).value_or("");
  std::vector<std::string> known;
  for (const auto& [name, value] : words) {
    if (text == name) return value;
    known.emplace_back(name);
  }
  const std::string expected = fmt::format("one of {}", fmt::join(known, ", "));
  if (!object.has(key)) missing(object, key, expected);
  object.fail(key, expected);
}

double number_within(
    const JsonObject& object, const std::string& key, double least, double most, double otherwise) {
  const double value = object.maybe_number(key).value_or(otherwise);
  if (value < least || value > most) {
    object.fail(key, fmt::format("a number from {} to {}", least, most));
  }
  return value;
}

// A number for all channels, or a list with one for each.
std::array<float, 3> for_channels(const JsonObject& object,
                                  const std::string& key,
                                  int channels,
                                  float otherwise) {
  std::array<float, 3> values{otherwise, otherwise, otherwise};
  if (!object.has(key)) return values;
  if (object.value(key).is_array()) {
    const auto list = object.numbers(key, static_cast<std::size_t>(channels));
    std::ranges::transform(list, values.begin(), [](double v) { return static_cast<float>(v); });
  } else {
    values.fill(static_cast<float>(object.number(key)));
  }
  for (const float value : values) {
    if (!(std::abs(value) <= 1e6f)) object.fail(key, "numbers within 1e6");
  }
  return values;
}

NetworkInput input_of(const JsonObject& json) {
  using Layout = NetworkInput::Layout;
  using Fit = NetworkInput::Fit;
  NetworkInput input;
  input.fit =
      word<Fit>(json,
                "fit",
                {{"frame", Fit::kFrame}, {"tiles", Fit::kTiles}, {"letterbox", Fit::kLetterbox}});
  std::vector<std::string> known = {"layout", "mean", "scale", "fit"};
  if (input.fit == Fit::kFrame) {
    known.emplace_back("multiple_px");
  } else {
    known.insert(known.end(), {"width", "height"});
    known.emplace_back(input.fit == Fit::kTiles ? "overlap_px" : "resize");
  }
  json.expect_keys_among(known);
  input.layout = word<Layout>(
      json, "layout", {{"grey", Layout::kGrey}, {"rgb", Layout::kRgb}, {"bgr", Layout::kBgr}});
  input.mean = for_channels(json, "mean", input.channels(), 0);
  input.scale = for_channels(json, "scale", input.channels(), 1);
  if (input.fit == Fit::kFrame) {
    if (json.has("multiple_px")) {
      input.multiple_px = static_cast<int>(json.whole("multiple_px", 1, 1024));
    }
    return input;
  }
  input.width = static_cast<int>(json.whole("width", 8, kMostPx));
  input.height = static_cast<int>(json.whole("height", 8, kMostPx));
  if (input.fit == Fit::kLetterbox) {
    using Resize = NetworkInput::Resize;
    input.resize = word<Resize>(
        json, "resize", {{"area", Resize::kArea}, {"linear", Resize::kLinear}}, Resize::kArea);
  }
  if (input.fit == Fit::kTiles) {
    const int most = std::min(input.width, input.height) / 2;
    input.overlap_px = static_cast<int>(json.whole("overlap_px", 0, most));
  }
  return input;
}

HeatMapOutput heat_map_of(const JsonObject& json) {
  json.expect_keys_among(
      {"kind", "heat", "offset", "size", "activation", "size_scale", "size_unit"});
  HeatMapOutput output;
  output.heat = json.text("heat");
  output.offset = json.text("offset");
  output.size = json.text("size");
  output.needs_sigmoid =
      word<bool>(json, "activation", {{"none", false}, {"sigmoid", true}}, false);
  output.is_size_log = word<bool>(json, "size_scale", {{"linear", false}, {"log", true}}, false);
  output.is_size_in_cells = word<bool>(json, "size_unit", {{"px", false}, {"cell", true}}, false);
  return output;
}

YoloOutput yolov8_of(const JsonObject& json) {
  using Order = YoloOutput::Order;
  json.expect_keys_among({"kind", "boxes", "order"});
  return {json.text("boxes"),
          word<Order>(json,
                      "order",
                      {{"values_first", Order::kValuesFirst}, {"boxes_first", Order::kBoxesFirst}},
                      Order::kFromShape)};
}

decltype(ModelDescription::output) output_of(const JsonObject& json) {
  enum class Kind { kHeatMap, kYolov5, kYolov8 };
  const Kind kind = word<Kind>(
      json,
      "kind",
      {{"heat_map", Kind::kHeatMap}, {"yolov5", Kind::kYolov5}, {"yolov8", Kind::kYolov8}});
  if (kind == Kind::kHeatMap) return heat_map_of(json);
  if (kind == Kind::kYolov8) return yolov8_of(json);
  json.expect_keys_among({"kind", "boxes"});
  return YoloOutput{json.text("boxes"), YoloOutput::Order::kYolov5};
}

std::vector<std::string> classes_of(const JsonObject& json) {
  std::vector<std::string> classes = json.texts("classes");
  const auto usable = [](const std::string& name) {
    return !name.empty() && name.size() <= 100 && utf8_fault(name) == std::string::npos &&
           std::ranges::none_of(name, is_control);
  };
  if (classes.empty() || classes.size() > kMostClasses || !std::ranges::all_of(classes, usable)) {
    json.fail("classes", fmt::format("1 to {} names of 1 to 100 bytes", kMostClasses));
  }
  return classes;
}

}  // namespace

std::vector<std::string> output_names(const ModelDescription& description) {
  if (const auto* map = std::get_if<HeatMapOutput>(&description.output)) {
    return {map->heat, map->offset, map->size};
  }
  return {std::get<YoloOutput>(description.output).boxes};
}

std::filesystem::path description_path(const std::filesystem::path& model) {
  return std::filesystem::path(model).replace_extension(".json");
}

ModelDescription read_description(const std::filesystem::path& path) {
  return description_from(read_file(path, kMostBytes), path.string());
}

ModelDescription description_from(std::string_view text, const std::string& file) {
  const JsonDocument document(text, {file});
  const JsonObject json = document.with_lines_of(text);
  json.expect_keys_among(
      {"format", "input", "output", "classes", "score_threshold", "confident_score", "nms_iou"});
  const std::string format = fmt::format("\"{}\"", kFormat);
  if (!json.has("format")) missing(json, "format", format);
  if (json.text("format") != kFormat) json.fail("format", format);
  if (!json.has("input")) missing(json, "input", "an object with layout and fit");
  if (!json.has("output")) missing(json, "output", "an object with kind");
  ModelDescription description;
  description.input = input_of(json.object("input"));
  description.output = output_of(json.object("output"));
  description.classes = classes_of(json);
  description.score_threshold = number_within(json, "score_threshold", 0, 1, 0.1);
  if (json.has("confident_score")) {
    description.confident_score =
        number_within(json, "confident_score", description.score_threshold, 1, 1);
  }
  description.nms_iou = number_within(json, "nms_iou", 0, 1, 0.5);
  return description;
}

}  // namespace airtruth::network
