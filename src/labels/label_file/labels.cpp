// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <string_view>
#include <type_traits>

#include <airtruth/labels.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/json/json_object.h"
#include "foundation/json/or_null.h"
#include "labels/annotation/object_class.h"
#include "labels/label_file/label_file.h"

namespace airtruth::label_file {

std::optional<double> rate_of(const std::optional<double>& value) {
  return value && *value > 0 && *value <= kHighestRate_hz ? value : std::nullopt;
}

void get_known(const JsonObject& json, Label& label, const char* visible_key) {
  each_known(label, visible_key, [&]<typename T>(const char* key, std::optional<T>& value) {
    if constexpr (std::is_same_v<T, bool>)
      value = json.maybe_truth(key);
    else
      value = json.maybe_number(key);
  });
}

nlohmann::ordered_json json_of_label(const Label& label) {
  const Box& b = label.box_px;
  nlohmann::ordered_json json = {{"track", label.track},
                                 {"category", label.category},
                                 {"box_px", {b.x, b.y, b.width, b.height}}};
  if (!annotation::is_aircraft(label.object_class)) json["class"] = label.object_class;
  each_known(
      label, "visible", [&](const char* key, const auto& value) { json[key] = or_null(value); });
  json["area_px"] = or_null(label.area_px);
  return json;
}

Label label_of_json(const JsonObject& json) {
  Label label;
  label.track = json.whole("track");
  label.category = json.text("category");
  const auto box = json.numbers("box_px", 4);
  label.box_px = {box[0], box[1], box[2], box[3]};
  label.object_class = json.maybe_text("class").value_or(label.object_class);
  if (!annotation::is_object_class(label.object_class) && label.object_class != kIgnore)
    json.fail("class", "aircraft, bird, multirotor, balloon, glint, dirt, insect or ignore");
  get_known(json, label, "visible");
  label.area_px = json.maybe_number("area_px");
  return label;
}

std::optional<std::string> repeated_track_in(const exchange::LabelledFrame& frame) {
  std::set<std::int64_t> seen;
  for (const Label& label : frame.labels)
    if (label.object_class != kIgnore && !seen.insert(label.track).second)
      return fmt::format("has the track {} a second time in frame {}", label.track, frame.frame);
  return std::nullopt;
}

}  // namespace airtruth::label_file

namespace airtruth::exchange {
namespace {

using namespace label_file;

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "airtruth labels 1";

int side(const JsonObject& json, const char* key) {
  return json.has(key) ? static_cast<int>(json.whole(key, 1, kLongestSide_px)) : 0;
}

LabelledFrame frame_of(const JsonObject& json) {
  LabelledFrame frame;
  frame.frame = json.count("frame");
  frame.time_s = json.maybe_number("time_s");
  frame.picture = json.maybe_text("picture").value_or("");
  if (std::ranges::any_of(frame.picture, is_control))
    json.fail("picture", "a name without control characters");
  frame.image_id = json.maybe_integer("image_id");
  for (const JsonObject& label : json.objects("labels"))
    frame.labels.push_back(label_of_json(label));
  if (const auto repeated = repeated_track_in(frame)) json.fail(*repeated);
  return frame;
}

Clip clip_of(const JsonObject& json) {
  if (json.text("format") != kFormat) json.fail("format", std::string("'") + kFormat + "'");
  Clip clip;
  clip.name = json.text("name");
  // Files and folders of exports and runs have it; a manipulated one must not lead out of theirs.
  if (!is_plain_file_name(clip.name)) json.fail("name", kPlainFileName);
  clip.media = json.maybe_text("media").value_or("");
  clip.width = side(json, "width");
  clip.height = side(json, "height");
  clip.frame_rate_hz = json.maybe_number("frame_rate_hz");
  if (clip.frame_rate_hz && !rate_of(clip.frame_rate_hz))
    json.fail("frame_rate_hz", fmt::format("a number above 0, up to {}", kHighestRate_hz));
  if (json.has("category_ids"))
    for (const JsonObject& category : json.objects("category_ids"))
      clip.category_ids[category.whole("id")] = category.text("name");
  return clip;
}

std::string json_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string labels_jsonl(const Clip& clip) {
  Json head = {{"format", kFormat}, {"name", clip.name}};
  head["media"] = clip.media.empty() ? Json() : Json(clip.media.string());
  head["width"] = clip.width > 0 ? Json(clip.width) : Json();
  head["height"] = clip.height > 0 ? Json(clip.height) : Json();
  head["frame_rate_hz"] = or_null(clip.frame_rate_hz);
  for (const auto& [id, name] : clip.category_ids)
    head["category_ids"].push_back({{"id", id}, {"name", name}});
  std::string text = json_line(head);
  for (const LabelledFrame& frame : clip.frames) {
    Json json = {{"frame", frame.frame}};
    json["time_s"] = or_null(frame.time_s);
    json["picture"] = frame.picture.empty() ? Json() : Json(frame.picture);
    json["image_id"] = or_null(frame.image_id);
    json["labels"] = Json::array();
    for (const Label& label : frame.labels) json["labels"].push_back(json_of_label(label));
    text += json_line(json);
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
    const JsonDocument json(std::string_view(text).substr(at, end - at), {file.string(), line});
    if (line == 1)
      clip = clip_of(json);
    else
      clip.frames.push_back(frame_of(json));
    at = end + 1;
  }
  if (line == 0) throw Error("is empty; expected labels", {file.string()});
  if (!clip.media.empty()) clip.media = file.parent_path() / clip.media;
  return clip;
}

std::vector<std::int64_t> tracks_of(const Clip& clip) {
  std::set<std::int64_t> tracks;
  for (const LabelledFrame& frame : clip.frames)
    for (const Label& label : frame.labels) tracks.insert(label.track);
  return {tracks.begin(), tracks.end()};
}

}  // namespace airtruth::exchange
