// SPDX-License-Identifier: Apache-2.0
#include "truth/exchange/labels.h"

#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::exchange {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "airtruth labels 1";

template <typename T>
void put(Json& json, const char* key, const std::optional<T>& value) {
  if (value) json[key] = *value;
}

// Bounds of whole numbers: a double holds them exactly, as it does all numbers of the imported
// formats.
constexpr std::int64_t kLargestWhole = std::int64_t{1} << 53;
constexpr std::int64_t kLongestSide_px = 1'000'000;
constexpr double kHighestRate_hz = 1e6;

template <typename T>
std::optional<T> get(const Json& json, const char* key) {
  return json.contains(key) ? std::optional(json.at(key).get<T>()) : std::nullopt;
}

[[noreturn]] void fail(const Json& value, const char* key, const std::string& expected) {
  throw Error(fmt::format("{} is {}; expected {}", key, value.dump().substr(0, 40), expected));
}

// The number is parsed from its text, because get<int>() would truncate it to the type's width.
std::int64_t whole(const Json& json, const char* key, std::int64_t least, std::int64_t most) {
  const Json& value = json.at(key);
  const double number = value.is_number() ? value.get<double>() : NAN;
  if (!(number >= double(least) && number <= double(most)) || number != std::floor(number))
    fail(value, key, fmt::format("a whole number from {} to {}", least, most));
  return static_cast<std::int64_t>(number);
}

std::optional<double> maybe_number(const Json& json, const char* key) {
  if (!json.contains(key)) return std::nullopt;
  if (!json.at(key).is_number()) fail(json.at(key), key, "a number");
  return json.at(key).get<double>();
}

int side(const Json& json, const char* key) {
  return json.contains(key) ? static_cast<int>(whole(json, key, 1, kLongestSide_px)) : 0;
}

std::optional<double> rate(const Json& json, const char* key) {
  const auto found = maybe_number(json, key);
  if (found && !(*found > 0 && *found <= kHighestRate_hz))
    fail(json.at(key), key, fmt::format("a number above 0, up to {}", kHighestRate_hz));
  return found;
}

Json json_of(const Label& label) {
  const Box& b = label.box_px;
  Json json = {{"track", label.track},
               {"category", label.category},
               {"box_px", {b.x, b.y, b.width, b.height}}};
  put(json, "visible", label.visible);
  put(json, "occluded", label.occluded);
  put(json, "truncated", label.truncated);
  put(json, "range_m", label.range_m);
  put(json, "above_horizon", label.above_horizon);
  return json;
}

Label label_of(const Json& json) {
  Label label;
  label.track = whole(json, "track", -kLargestWhole, kLargestWhole);
  label.category = json.at("category").get<std::string>();
  const auto box = json.at("box_px").get<std::array<double, 4>>();
  label.box_px = {box[0], box[1], box[2], box[3]};
  label.visible = maybe_number(json, "visible");
  label.occluded = get<bool>(json, "occluded");
  label.truncated = get<bool>(json, "truncated");
  label.range_m = maybe_number(json, "range_m");
  label.above_horizon = get<bool>(json, "above_horizon");
  return label;
}

LabelledFrame frame_of(const Json& json) {
  LabelledFrame frame;
  frame.frame = whole(json, "frame", 0, kLargestWhole);
  frame.time_s = maybe_number(json, "time_s");
  for (const Json& label : json.at("labels")) frame.labels.push_back(label_of(label));
  return frame;
}

Clip clip_of(const Json& json) {
  if (json.at("format") != kFormat)
    throw Error("is not of the format '" + std::string(kFormat) + "'");
  Clip clip;
  clip.name = json.at("name").get<std::string>();
  clip.media = get<std::string>(json, "media").value_or("");
  clip.width = side(json, "width");
  clip.height = side(json, "height");
  clip.frame_rate_hz = rate(json, "frame_rate_hz");
  return clip;
}

std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string labels_jsonl(const Clip& clip) {
  Json head = {{"format", kFormat}, {"name", clip.name}};
  if (!clip.media.empty()) head["media"] = clip.media.string();
  if (clip.width > 0) head["width"] = clip.width;
  if (clip.height > 0) head["height"] = clip.height;
  put(head, "frame_rate_hz", clip.frame_rate_hz);
  std::string text = line_of(head);
  for (const LabelledFrame& frame : clip.frames) {
    Json json = {{"frame", frame.frame}};
    put(json, "time_s", frame.time_s);
    json["labels"] = Json::array();
    for (const Label& label : frame.labels) json["labels"].push_back(json_of(label));
    text += line_of(json);
  }
  return text;
}

Clip read_labels(const fs::path& file) {
  const std::string text = read_file(file);
  Clip clip;
  int line = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    ++line;
    try {
      const Json json = Json::parse(text.substr(at, end - at));
      if (line == 1)
        clip = clip_of(json);
      else
        clip.frames.push_back(frame_of(json));
    } catch (const Json::exception&) {
      throw Error("is no line of labels", {file.string(), line});
    } catch (const Error& error) {
      throw Error(error.message(), {file.string(), line});
    }
    at = end + 1;
  }
  if (line == 0) throw Error("is empty; expected labels", {file.string()});
  return clip;
}

std::vector<std::int64_t> tracks_of(const Clip& clip) {
  std::set<std::int64_t> tracks;
  for (const LabelledFrame& frame : clip.frames)
    for (const Label& label : frame.labels) tracks.insert(label.track);
  return {tracks.begin(), tracks.end()};
}

}  // namespace airtruth::exchange
