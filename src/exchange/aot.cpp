// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/files.h"
#include "exchange/json_file.h"
#include "exchange/parts.h"
#include "exchange/text.h"

// Airborne Object Tracking (Amazon 2021, "airborne-detection-starter-kit", DATASET.md): one
// groundtruth.json; `samples` holds a flight a clip, its `entities` one entry for each object of
// each frame, and one without id and bb for a frame that shows none. Boxes are [left, top, width,
// height] from (0, 0); time in nanoseconds; ids are a kind and a number, "Airplane1".
namespace airtruth::exchange {
namespace {

using Json = nlohmann::ordered_json;

class AotWriter : public Writer {
 public:
  AotWriter(fs::path root, const WriteOptions& options)
      : root_(std::move(root)), options_(options) {
    for (const std::string& part : options.parts) {
      fs::create_directories(file_of(part).parent_path());
      files_[part].open(part_path(file_of(part)), std::ios::binary);
      files_[part] << "{\"metadata\":{\"description\":\"made by airtruth\"},\n\"samples\":{";
    }
  }

  fs::path image(const Clip& clip, const std::string& part, std::size_t i) const override {
    return fs::path(part) / "Images" / clip.name / name_of(i);
  }

  void add(const Clip& clip, const std::string& part) override {
    Json entities = Json::array();
    for (std::size_t i = 0; i < clip.frames.size(); ++i) add_frame(clip, i, entities);
    Json about = {{"data_path", "Images/" + clip.name + "/"},
                  {"flight_id", clip.name},
                  {"number_of_frames", clip.frames.size()},
                  {"resolution", {{"height", clip.height}, {"width", clip.width}}}};
    if (clip.frame_rate_hz) about["fps"] = *clip.frame_rate_hz;
    std::ofstream& file = files_.at(part);
    file << (any_[part] ? ",\n" : "\n") << Json(clip.name).dump() << ":"
         << Json{{"metadata", about}, {"entities", entities}}.dump();
    any_[part] = true;
    if (!file) throw Error("cannot be written: is the disk full?", {file_of(part).string()});
  }

  void finish() override {
    for (auto& [part, file] : files_) {
      file << "}}\n";
      file.close();
      if (!file) throw Error("cannot be written: is the disk full?", {file_of(part).string()});
      fs::rename(part_path(file_of(part)), file_of(part));
    }
  }

 private:
  fs::path file_of(const std::string& part) const {
    return root_ / part / "ImageSets" / "groundtruth.json";
  }
  std::string name_of(std::size_t i) const {
    return padded(static_cast<std::int64_t>(i), 6) + options_.image_extension;
  }

  void add_frame(const Clip& clip, std::size_t i, Json& entities) const {
    const LabelledFrame& frame = clip.frames[i];
    Json bare = Json::object();
    if (frame.time_s) bare["time"] = std::llround(*frame.time_s * 1e9);
    bare["blob"] = {{"frame", i}};
    bare["flight_id"] = clip.name;
    bare["img_name"] = name_of(i);
    if (frame.labels.empty()) bare["labels"] = Json::object();
    if (frame.labels.empty()) entities.push_back(bare);
    for (const Label& label : frame.labels) {
      Json entity = bare;
      const Box& b = label.box_px;
      entity["id"] = fmt::format("Airplane{}", label.track);
      entity["bb"] = {b.x, b.y, b.width, b.height};
      if (label.range_m) entity["blob"]["range_distance_m"] = *label.range_m;
      entity["blob"]["category"] = label.category;
      const int above = label.above_horizon ? (*label.above_horizon ? 1 : -1) : 0;
      entity["labels"] = {{"is_above_horizon", above}};
      entities.push_back(entity);
    }
  }

  fs::path root_;
  WriteOptions options_;
  std::map<std::string, std::ofstream> files_;
  std::map<std::string, bool> any_;
};

class FlightReader {
 public:
  FlightReader(const fs::path& file, const std::string& id, const JsonObject& flight, LeftOut& left)
      : file_(file), flight_(flight), left_out_(left) {
    clip_.name = id;
  }

  Clip read() {
    const JsonObject about = flight_.object("metadata");
    clip_.frame_rate_hz = about.maybe_number("fps");
    if (about.has("resolution")) {
      clip_.width = side_of(about.object("resolution").number("width"));
      clip_.height = side_of(about.object("resolution").number("height"));
    }
    const fs::path pictures = file_.parent_path().parent_path() / "Images" / clip_.name;
    if (!entries(pictures).empty()) clip_.media = pictures;
    const auto frames =
        whole_in(about.maybe_number("number_of_frames").value_or(0), 0, kMostFrames);
    if (!frames) about.fail("number_of_frames is no number of frames");
    clip_.frames.resize(static_cast<std::size_t>(*frames));
    for (const JsonObject& entity : flight_.objects("entities")) add(entity);
    for (std::size_t i = 0; i < clip_.frames.size(); ++i)
      clip_.frames[i].frame = static_cast<std::int64_t>(i);
    return clip_;
  }

 private:
  void add(const JsonObject& entity) {
    const JsonObject blob = entity.object("blob");
    const std::int64_t number = blob.whole("frame");
    if (number < 0 || number > kMostFrames) blob.fail("frame is out of range");
    const auto i = static_cast<std::size_t>(number);
    if (i >= clip_.frames.size()) clip_.frames.resize(i + 1);
    LabelledFrame& frame = clip_.frames[i];
    if (const auto time = entity.maybe_number("time")) frame.time_s = *time / 1e9;
    if (!entity.has("id") || !entity.has("bb")) return;
    const std::vector<double> bb = entity.numbers("bb");
    if (bb.size() != 4) entity.fail("bb has not 4 numbers");
    Label label;
    label.box_px = {bb[0], bb[1], bb[2], bb[3]};
    label.track = track_of(entity.text("id"));
    label.category =
        blob.has("category") ? blob.text("category") : name_and_number(entity.text("id")).first;
    label.range_m = range_of(blob);
    if (entity.has("labels")) {
      const auto above = entity.object("labels").maybe_number("is_above_horizon");
      if (above && *above != 0) label.above_horizon = *above > 0;
    }
    if (is_in_picture(label.box_px, clip_.width, clip_.height))
      frame.labels.push_back(label);
    else
      left_out_.add("boxes that are empty or outside their image", entity.place());
  }

  // The published files write NaN as a string or leave it out.
  static std::optional<double> range_of(const JsonObject& blob) {
    try {
      return blob.maybe_number("range_distance_m");
    } catch (const Error&) {
      return std::nullopt;
    }
  }

  // The number of the id where that is free, since "Airplane1" and "Helicopter1" are two objects.
  std::int64_t track_of(const std::string& id) {
    if (const auto found = tracks_.find(id); found != tracks_.end()) return found->second;
    std::int64_t track = name_and_number(id).second.value_or(1);
    while (std::any_of(
        tracks_.begin(), tracks_.end(), [&](const auto& known) { return known.second == track; }))
      ++track;
    return tracks_[id] = track;
  }

  fs::path file_;
  const JsonObject& flight_;
  LeftOut& left_out_;
  std::map<std::string, std::int64_t> tracks_;
  Clip clip_;
};

}  // namespace

std::unique_ptr<Writer> aot_writer(const fs::path& root, const WriteOptions& options) {
  return std::make_unique<AotWriter>(root, options);
}

Clips read_aot(const fs::path& source, const ReadOptions&, const Warn& warn) {
  std::vector<fs::path> files;
  if (fs::is_directory(source)) {
    const fs::path own = source / "ImageSets" / "groundtruth.json";
    if (fs::exists(own)) files.push_back(own);
    for (const fs::path& part : entries(source))
      if (const fs::path file = part / "ImageSets" / "groundtruth.json"; fs::exists(file))
        files.push_back(file);
  } else {
    files = {source};
  }
  if (files.empty()) throw Error("holds no ImageSets/groundtruth.json", {source.string()});
  LeftOut left_out(warn);
  Clips clips;
  for (const fs::path& file : files) {
    const JsonFile json(file);
    const JsonObject samples = json.object("samples");
    for (const std::string& id : samples.keys())
      clips.push_back(FlightReader(file, id, samples.object(id.c_str()), left_out).read());
  }
  return clips;
}

}  // namespace airtruth::exchange
