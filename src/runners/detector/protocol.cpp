// SPDX-License-Identifier: Apache-2.0
#include "runners/detector/protocol.h"

#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "camera/lens/lens.h"
#include "foundation/base/text.h"
#include "foundation/json/parse_json.h"

namespace airtruth::detector {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const std::string& what) { throw process::Failure(what); }

std::string shown(std::string_view text) { return quoted_excerpt(text, 60); }

Json object_of(std::string_view line) {
  Json json = parse_json(line);
  if (json.is_object()) return json;
  if (is_nested_too_deep(line))
    fail(fmt::format("sent {}, nested deeper than {} levels", shown(line), kMostNesting));
  for (const char* word : {"NaN", "Infinity"})
    if (line.find(word) != std::string_view::npos)
      fail(std::string("sent ") + word + "; expected finite numbers");
  fail("sent " + shown(line) + ", which is no JSON object");
}

double number_of(const Json& json, const char* what) {
  if (!json.is_number() || !std::isfinite(json.get<double>()))
    fail(fmt::format("answered a {} of {}; expected a finite number", what, shown(json.dump())));
  return json.get<double>();
}

results::Detection detection_of(const Json& json) {
  if (!json.is_object() || !json.contains("box") || !json["box"].is_array() ||
      json["box"].size() != 4)
    fail("answered " + shown(json.dump()) + "; expected {\"box\":[x,y,width,height],\"score\":s}");
  results::Detection detection;
  const Json& box = json["box"];
  detection.box_px = {number_of(box[0], "box"),
                      number_of(box[1], "box"),
                      number_of(box[2], "box"),
                      number_of(box[3], "box")};
  detection.score = number_of(json.value("score", Json()), "score");
  if (json.contains("category")) {
    if (!json["category"].is_string() || json["category"].get<std::string>().empty())
      fail("answered a category of " + shown(json["category"].dump()) + "; expected a text");
    detection.category = json["category"].get<std::string>();
  }
  if (json.contains("track") && !json["track"].is_null()) {
    if (!json["track"].is_number_integer() || json["track"].get<double>() < 0 ||
        json["track"].get<double>() > 1e12)
      fail("answered a track of " + shown(json["track"].dump()) + "; expected a number from 0 on");
    detection.track = json["track"].get<std::int64_t>();
  }
  return detection;
}

}  // namespace

Hello hello_of(std::string_view line) {
  const Json json = object_of(line);
  if (!json.contains("hello") || !json["hello"].is_object())
    fail("sent " + shown(line) + " first; expected {\"hello\":{\"protocol\":1}}");
  const Json& hello = json["hello"];
  if (hello.value("protocol", Json()) != Json(kProtocol))
    fail(fmt::format("speaks protocol {}; expected {}",
                     shown(hello.value("protocol", Json()).dump()),
                     kProtocol));
  Hello result;
  const Json samples = hello.value("samples", Json("rgb"));
  if (samples == "gray")
    result.samples = SampleOrder::kGray;
  else if (samples != "rgb")
    fail("asks for samples of " + shown(samples.dump()) + "; expected \"rgb\" or \"gray\"");
  const Json frames = hello.value("frames", Json("pipe"));
  if (frames == "shared_memory")
    result.frames = FramesBy::kSharedMemory;
  else if (frames != "pipe")
    fail("asks for frames by " + shown(frames.dump()) + "; expected \"pipe\" or \"shared_memory\"");
  return result;
}

std::string begin_line(const SequenceInput& sequence, const std::string& shared_memory) {
  const lens::Facts lens = lens::facts_of(sequence.lens);
  Json begin = {{"sequence", sequence.name},
                {"width", sequence.width},
                {"height", sequence.height},
                {"frame_rate_hz", sequence.frame_rate_hz},
                {"lens",
                 {{"model", lens.model},
                  {"focal_px", lens.focal_px},
                  {"principal_point_px", lens.principal_point_px},
                  {"distortion", lens.distortion}}}};
  if (lens.max_angle_rad < kPi) begin["lens"]["max_angle_rad"] = lens.max_angle_rad;
  if (!shared_memory.empty()) begin["shared_memory"] = shared_memory;
  return Json{{"begin", begin}}.dump() + "\n";
}

std::string frame_line(const FrameInput& frame, std::size_t bytes) {
  Json json = {{"frame", frame.index}, {"time_s", frame.time_s}, {"bytes", bytes}};
  if (frame.turn) {
    const Quaternion& q = frame.turn->this_from_previous;
    json["this_from_previous"] = {q.w(), q.x(), q.y(), q.z()};
  }
  return json.dump() + "\n";
}

std::vector<results::Detection> detections_of(std::string_view line, std::int64_t index) {
  const Json json = object_of(line);
  const Json frame = json.value("frame", Json());
  if (!frame.is_number_integer())
    fail("answered " + shown(line) + "; expected {\"frame\":" + std::to_string(index) +
         ",\"detections\":[...]}");
  if (frame != Json(index))
    fail(fmt::format(
        "answered out of order: frame {}, when asked for frame {}", shown(frame.dump()), index));
  const Json list = json.value("detections", Json());
  if (!list.is_array()) fail(fmt::format("answered no list of detections for frame {}", index));
  if (list.size() > kMostInAnAnswer)
    fail(fmt::format("answered {} detections for frame {}; expected at most {}",
                     list.size(),
                     index,
                     kMostInAnAnswer));
  std::vector<results::Detection> detections;
  std::set<std::int64_t> tracks;
  for (const Json& one : list) {
    const std::optional<std::int64_t> track = detections.emplace_back(detection_of(one)).track;
    if (track && !tracks.insert(*track).second)
      fail(fmt::format(
          "answered track {} twice for frame {}; expected each once in a frame", *track, index));
  }
  return detections;
}

}  // namespace airtruth::detector
