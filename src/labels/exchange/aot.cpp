// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/unfinished.h"
#include "labels/annotation/object_class.h"
#include "labels/exchange/parts.h"
#include "labels/exchange/pictures.h"
#include "labels/exchange/python_json.h"
#include "labels/exchange/text.h"
#include "labels/label_file/label_file.h"

// Airborne Object Tracking (Amazon 2021, "airborne-detection-starter-kit": docs/DATASET.md,
// core/flight.py, core/frame.py, core/metrics): one groundtruth.json; `samples` holds one flight
// for each clip, its `entities` one entry for each object of each frame, and one without id and bb
// for a frame without an object. Boxes are [left, top, width, height] from (0, 0); ids are a kind
// and a number, "Airplane1". A picture is Images/FLIGHT/TIMEFLIGHT.png with the entity's time in
// nanoseconds: the metrics join detections to truth only by that name, over all flights, and the
// loader makes it from time and flight. `metadata` holds fps and the duration in milliseconds.
namespace airtruth::exchange {
namespace {

using Json = nlohmann::ordered_json;

// Origin of the times, in nanoseconds. With it all times have 19 digits, as AOT's own, which count
// from 1970. Picture names therefore sort by time, and those of two flights differ whatever the
// flights' names are.
constexpr std::int64_t kTimeOriginNs = 1'500'000'000'000'000'000;
// Largest distance of a time from the first frame, 5 years. A time farther away is invalid.
constexpr double kLongestClipS = 1.5e8;
// AOT's own rate, in frames a second, for clips whose frame rate is unknown.
constexpr double kNominalRateHz = 10;

// Times of the frames in nanoseconds from the first. Where they are unknown or two are equal, they
// follow from the frame rate.
struct Times {
  std::vector<std::int64_t> ns;
  double rate_hz = kNominalRateHz;
  bool are_nominal = false;
};

Times times_of(const Clip& clip) {
  Times times;
  times.rate_hz = clip.frame_rate_hz.value_or(kNominalRateHz);
  for (const LabelledFrame& frame : clip.frames) {
    const bool is_later = frame.time_s && std::abs(*frame.time_s) < kLongestClipS &&
                          (times.ns.empty() || std::llround(*frame.time_s * 1e9) > times.ns.back());
    if (!is_later) times.are_nominal = true;
    if (times.are_nominal) break;
    times.ns.push_back(std::llround(*frame.time_s * 1e9));
  }
  if (!times.are_nominal) return times;
  times.ns.clear();
  for (std::size_t i = 0; i < clip.frames.size(); ++i)
    times.ns.push_back(std::llround(static_cast<double>(i) / times.rate_hz * 1e9));
  return times;
}

class AotWriter : public Writer {
 public:
  explicit AotWriter(const Writing& to) : root_(to.root) {
    for (const std::string& part : to.options.parts) {
      fs::create_directories(file_of(part).parent_path());
      files_.try_emplace(part, file_of(part)).first->second.out()
          << "{\"metadata\":{\"description\":\"made by airtruth\"},\n\"samples\":{";
    }
  }

  std::vector<fs::path> images(const Clip& clip, const std::string& part) const override {
    std::vector<fs::path> files;
    for (const std::int64_t time_ns : times_of(clip).ns)
      files.push_back(fs::path(part) / "Images" / clip.name / name_of(clip, time_ns));
    return files;
  }

  void add(const Clip& clip, const std::string& part) override {
    const Times times = times_of(clip);
    Json entities = Json::array();
    for (std::size_t i = 0; i < clip.frames.size(); ++i) add_frame(clip, i, times.ns[i], entities);
    const double duration_ms = static_cast<double>(clip.frames.size()) / times.rate_hz * 1000;
    Json about = {{"data_path", "Images/" + clip.name + "/"},
                  {"flight_id", clip.name},
                  {"fps", times.rate_hz},
                  {"number_of_frames", clip.frames.size()},
                  {"duration", duration_ms},
                  {"resolution", {{"height", clip.height}, {"width", clip.width}}},
                  {"time_origin_ns", kTimeOriginNs}};
    if (!clip.frame_rate_hz) about["fps_is_nominal"] = true;
    if (times.are_nominal) about["time_is_nominal"] = true;
    PartFile& file = files_.at(part);
    file.out() << (any_[part] ? ",\n" : "\n") << Json(clip.name).dump() << ":"
               << Json{{"metadata", about}, {"entities", entities}}.dump();
    any_[part] = true;
    file.check_written();
  }

  void finish() override {
    for (auto& [part, file] : files_) {
      file.out() << "}}\n";
      file.finish();
    }
  }

 private:
  fs::path file_of(const std::string& part) const {
    return root_ / part / "ImageSets" / "groundtruth.json";
  }
  static std::string name_of(const Clip& clip, std::int64_t time_ns) {
    return std::to_string(kTimeOriginNs + time_ns) + clip.name + ".png";
  }

  // The set's own word for an object; empty for what is not in the air.
  static std::string_view kind_of(const Label& label) {
    if (annotation::is_aircraft(label.object_class)) return "Airplane";
    if (label.object_class == "bird") return "Bird";
    if (label.object_class == "multirotor") return "Drone";
    return label.object_class == "balloon" ? "Airborne" : "";
  }

  static void add_frame(const Clip& clip, std::size_t i, std::int64_t time_ns, Json& entities) {
    const LabelledFrame& frame = clip.frames[i];
    Json bare = {{"time", kTimeOriginNs + time_ns},
                 {"blob", {{"frame", i}}},
                 {"flight_id", clip.name},
                 {"img_name", name_of(clip, time_ns)}};
    const std::size_t before = entities.size();
    for (const Label& label : frame.labels) {
      const std::string_view kind = kind_of(label);
      if (kind.empty()) continue;
      Json entity = bare;
      const Box& b = label.box_px;
      entity["id"] = fmt::format("{}{}", kind, label.track);
      entity["bb"] = {b.x, b.y, b.width, b.height};
      // A range marks an object as planned to the metrics, which ask it of their encounters.
      if (label.range_m && annotation::is_aircraft(label.object_class))
        entity["blob"]["range_distance_m"] = *label.range_m;
      entity["blob"]["category"] = label.category;
      put(entity["blob"], "contrast_to_noise", label.contrast_to_noise);
      const int above = label.above_horizon ? (*label.above_horizon ? 1 : -1) : 0;
      entity["labels"] = {{"is_above_horizon", above}};
      entities.push_back(entity);
    }
    if (entities.size() > before) return;
    bare["labels"] = Json::object();
    entities.push_back(bare);
  }

  fs::path root_;
  std::map<std::string, PartFile> files_;
  std::map<std::string, bool> any_;
};

class FlightReader {
 public:
  FlightReader(const fs::path& file,
               const std::string& id,
               const JsonObject& flight,
               const Reading& in)
      : file_(file), flight_(flight), in_(in) {
    clip_.name = id;
  }

  Clip read() {
    const JsonObject about = flight_.object("metadata");
    if (!about.maybe_truth("fps_is_nominal").value_or(false))
      clip_.frame_rate_hz = label_file::rate_of(about.maybe_number("fps"));
    has_times_ = !about.maybe_truth("time_is_nominal").value_or(false);
    origin_ns_ = about.maybe_integer("time_origin_ns");
    if (about.has("resolution")) {
      clip_.width = side_of(about.object("resolution").number("width"));
      clip_.height = side_of(about.object("resolution").number("height"));
    }
    const auto frames = whole_in(about.maybe_number("number_of_frames").value_or(0), 0, kMaxFrames);
    if (!frames) about.fail("number_of_frames is no number of frames");
    if (*frames > 0) frame_at(clip_, static_cast<std::size_t>(*frames) - 1, in_);
    const std::vector<JsonObject> entities = flight_.objects("entities");
    // Times in the published files count from 1970; those of a Clip count from the flight's first
    // frame.
    if (!origin_ns_)
      for (const JsonObject& entity : entities)
        if (const auto time = entity.maybe_integer("time"))
          origin_ns_ = std::min(origin_ns_.value_or(*time), *time);
    for (const JsonObject& entity : entities) add(entity);
    // Pictures belong to frames by img_name.
    const fs::path images = file_.parent_path().parent_path() / "Images" / clip_.name;
    if (!pictures_in(images).empty()) join_by_name(clip_, images, in_.warn);
    return clip_;
  }

 private:
  void add(const JsonObject& entity) {
    const JsonObject blob = entity.object("blob");
    const std::int64_t number = blob.whole("frame");
    if (number < 0 || number > kMaxFrames) blob.fail("frame is out of range");
    LabelledFrame& frame = frame_at(clip_, static_cast<std::size_t>(number), in_);
    if (const auto name = entity.maybe_text("img_name")) {
      expect_inside(*name, {file_.string()});
      frame.picture = *name;
    }
    const auto time = entity.maybe_integer("time");
    if (time && has_times_) frame.time_s = static_cast<double>(*time - *origin_ns_) / 1e9;
    if (!entity.has("id") || !entity.has("bb")) return;
    const std::vector<double> bb = entity.numbers("bb", 4);
    Label label;
    label.box_px = {bb[0], bb[1], bb[2], bb[3]};
    label.track = track_of(entity.text("id"));
    const std::string kind = name_and_number(entity.text("id")).first;
    label.category = blob.has("category") ? blob.text("category") : kind;
    // The writer above names balloons so; in the published files it is any other object in the air.
    const auto stated = blob.has("category") && kind == "Airborne"
                            ? std::optional<std::string_view>("balloon")
                            : annotation::class_of_category(kind);
    if (stated) in_.classes.emplace(label.category, *stated);
    label.range_m = range_of(blob);
    label.contrast_to_noise = blob.maybe_number("contrast_to_noise");
    if (entity.has("labels")) {
      const auto above = entity.object("labels").maybe_number("is_above_horizon");
      if (above && *above != 0) label.above_horizon = *above > 0;
    }
    add_label(frame.labels, label, clip_, in_.left_out, entity.place());
  }

  // Where a range is unknown, the published files contain NaN, a string or no key.
  static std::optional<double> range_of(const JsonObject& blob) {
    try {
      return blob.maybe_number("range_distance_m");
    } catch (const Error&) {
      return std::nullopt;
    }
  }

  // The track takes the number of the id, or the next one that is free, since "Airplane1" and
  // "Helicopter1" are two objects.
  std::int64_t track_of(const std::string& id) {
    const auto [known, is_new] = tracks_.try_emplace(id, 0);
    if (is_new) known->second = take_from(name_and_number(id).second.value_or(1));
    return known->second;
  }

  // Takes the first free number from `track` on. What it passes is made to lead there at once.
  std::int64_t take_from(std::int64_t track) {
    std::int64_t free = track;
    for (auto at = after_.find(free); at != after_.end(); at = after_.find(free)) free = at->second;
    while (track != free) track = std::exchange(after_[track], free);
    after_[free] = free + 1;
    return free;
  }

  fs::path file_;
  const JsonObject& flight_;
  const Reading& in_;
  std::map<std::string, std::int64_t> tracks_;
  // By each number that is taken, a later one below which none is free.
  std::map<std::int64_t, std::int64_t> after_;
  std::optional<std::int64_t> origin_ns_;
  bool has_times_ = true;
  Clip clip_;
};

}  // namespace

std::unique_ptr<Writer> aot_writer(const Writing& to) { return std::make_unique<AotWriter>(to); }

Clips read_aot(const Reading& in) {
  const char* const name = "ImageSets/groundtruth.json";
  std::vector<fs::path> folders = entries(in.source);
  folders.insert(folders.begin(), in.source);
  std::vector<fs::path> found;
  for (const fs::path& folder : folders)
    if (is_there(folder / name)) found.push_back(folder / name);
  Clips clips;
  for (const fs::path& file : files_of(in.source, found, name)) {
    const JsonDocument json = python_json(file);
    const JsonObject samples = json.object("samples");
    for (const std::string& id : samples.keys())
      clips.push_back(FlightReader(file, id, samples.object(id), in).read());
  }
  return clips;
}

}  // namespace airtruth::exchange
