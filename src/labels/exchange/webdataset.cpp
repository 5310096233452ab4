// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/json_object.h"
#include "foundation/tar/tar.h"
#include "labels/annotation/object_class.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/python_json.h"
#include "labels/exchange/text.h"
#include "labels/label_file/label_file.h"

// WebDataset (github.com/webdataset/webdataset, "The WebDataset Format"): tar archives
// PART-000000.tar, in which files of one sample follow each other and have one key, the name up to
// its first dot: KEY.jpg or KEY.png, and KEY.json. A dot in the name of a clip is therefore written
// %2E, and % is %25. Frames stand in the order of their sequences; a loader mixes shards and the
// samples of its buffer.
namespace airtruth::exchange {
namespace {

using Json = nlohmann::ordered_json;

std::string key_of(const Clip& clip, std::size_t i) {
  std::string key;
  for (const char letter : numbered_stem(clip, i))
    key += letter == '.' ? "%2E" : letter == '%' ? "%25" : std::string(1, letter);
  return key;
}

std::string json_of(const Clip& clip, std::size_t i) {
  const LabelledFrame& frame = clip.frames[i];
  Json json = {{"clip", clip.name}, {"frame", i}};
  put(json, "time_s", frame.time_s);
  if (clip.width > 0) json["width"] = clip.width;
  if (clip.height > 0) json["height"] = clip.height;
  put(json, "frame_rate_hz", clip.frame_rate_hz);
  json["labels"] = Json::array();
  for (const Label& label : frame.labels)
    json["labels"].push_back(label_file::json_of_label(label));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

class WebdatasetWriter : public FolderWriter {
 public:
  using FolderWriter::FolderWriter;

  void add(const Clip& clip, const std::string& part) override {
    Shards& shards = shards_[part];
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      if (!shards.open)
        shards.open.emplace(root_ / fmt::format("{}-{:06}.tar", part, shards.count++));
      const std::string key = key_of(clip, i);
      if (options_.with_images)
        shards.open->add(key + options_.image_extension, read_file(root_ / image(clip, part, i)));
      shards.open->add(key + ".json", json_of(clip, i));
      if (shards.open->bytes() >= options_.shard_bytes) close(shards);
    }
  }

  void finish() override {
    for (auto& [part, shards] : shards_) close(shards);
  }

 private:
  struct Shards {
    std::optional<tar::Writer> open;
    std::int64_t count = 0;
  };

  static void close(Shards& shards) {
    if (shards.open) shards.open->finish();
    shards.open.reset();
  }

  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return options_.staging / part / (key_of(clip, i) + options_.image_extension);
  }

  std::map<std::string, Shards> shards_;
};

void add(const JsonDocument& json, std::map<std::string, Clip>& clips, const Reading& in) {
  const std::string name = fs::path(json.text("clip")).filename().string();
  Clip& clip = clips[name];
  clip.name = name;
  clip.width = side_of(json.maybe_number("width"));
  clip.height = side_of(json.maybe_number("height"));
  clip.frame_rate_hz = label_file::rate_of(json.maybe_number("frame_rate_hz"));
  LabelledFrame frame{json.whole("frame", 0, kMaxFrames), json.maybe_number("time_s"), {}};
  for (const JsonObject& json_of_label : json.objects("labels")) {
    const Label label = label_file::label_of_json(json_of_label);
    // A label without a class is one of an aircraft.
    if (annotation::is_aircraft(label.object_class))
      in.classes.emplace(label.category, label.object_class);
    add_label(frame.labels, label, clip, in.left_out, json_of_label.place());
  }
  clip.frames.push_back(std::move(frame));
}

}  // namespace

std::unique_ptr<Writer> webdataset_writer(const Writing& to) {
  return std::make_unique<WebdatasetWriter>(to);
}

// Of the shards that the writer above makes, the labels alone: the pictures stay packed.
Clips read_webdataset(const Reading& in) {
  const std::string what = "sample (*.tar with *.json)";
  std::map<std::string, Clip> by_name;
  for (const fs::path& shard : files_of(in.source, files_with(in.source, ".tar"), what))
    tar::each_file(shard, ".json", [&](const std::string& name, const std::string& text) {
      add({text, Where{(shard / name).string()}}, by_name, in);
    });
  if (by_name.empty()) throw Error("holds no " + what, {in.source.string()});
  Clips clips;
  for (auto& [name, clip] : by_name) {
    std::ranges::stable_sort(clip.frames, {}, &LabelledFrame::frame);
    for (std::size_t i = 1; i < clip.frames.size(); ++i)
      if (clip.frames[i].frame == clip.frames[i - 1].frame)
        throw Error(fmt::format("holds frame {} of {} twice", clip.frames[i].frame, name),
                    {in.source.string()});
    clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace airtruth::exchange
