// SPDX-License-Identifier: Apache-2.0
#include "exchange/labels.h"

#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/files.h"

namespace airtruth::exchange {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "airtruth labels 1";

template <typename T>
void put(Json& json, const char* key, const std::optional<T>& value) {
  if (value) json[key] = *value;
}

template <typename T>
std::optional<T> get(const Json& json, const char* key) {
  return json.contains(key) ? std::optional(json.at(key).get<T>()) : std::nullopt;
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
  label.track = json.at("track").get<std::int64_t>();
  label.category = json.at("category").get<std::string>();
  const auto box = json.at("box_px").get<std::array<double, 4>>();
  label.box_px = {box[0], box[1], box[2], box[3]};
  label.visible = get<double>(json, "visible");
  label.occluded = get<bool>(json, "occluded");
  label.truncated = get<bool>(json, "truncated");
  label.range_m = get<double>(json, "range_m");
  label.above_horizon = get<bool>(json, "above_horizon");
  return label;
}

LabelledFrame frame_of(const Json& json) {
  LabelledFrame frame;
  frame.frame = json.at("frame").get<std::int64_t>();
  frame.time_s = get<double>(json, "time_s");
  for (const Json& label : json.at("labels")) frame.labels.push_back(label_of(label));
  return frame;
}

Clip clip_of(const Json& json) {
  if (json.at("format") != kFormat)
    throw Error("is not of the format '" + std::string(kFormat) + "'");
  Clip clip;
  clip.name = json.at("name").get<std::string>();
  clip.media = get<std::string>(json, "media").value_or("");
  clip.width = get<int>(json, "width").value_or(0);
  clip.height = get<int>(json, "height").value_or(0);
  clip.frame_rate_hz = get<double>(json, "frame_rate_hz");
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
