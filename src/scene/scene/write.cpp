// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "aircraft/wrapper/reader.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "scene/scene/camera_keys.h"
#include "scene/scene/scene.h"

namespace airtruth::scene {
namespace {

// Builds TOML text key by key. A key without a value is left out.
class Text {
 public:
  void heading(std::string_view title) { text_ += fmt::format("\n{}\n", title); }

  template <typename T>
  void add(std::string_view key, const T& value) {
    text_ += fmt::format("{} = {}\n", key, toml(value));
  }
  template <typename T>
  void add(std::string_view key, const std::optional<T>& value) {
    if (value) add(key, *value);
  }

  std::string take() { return std::move(text_); }

 private:
  static std::string toml(double value) {
    // TOML reads "-0" as an integer, which has no negative zero.
    if (value == 0 && std::signbit(value)) return "-0.0";
    return fmt::format("{}", value);
  }
  static std::string toml(bool value) { return value ? "true" : "false"; }
  static std::string toml(int value) { return fmt::format("{}", value); }
  static std::string toml(std::int64_t value) { return fmt::format("{}", value); }
  static std::string toml(const fs::path& path) { return toml(absolute_path(path).string()); }
  static std::string toml(const Vector3& v) {
    return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z());
  }
  static std::string toml(const YawPitchRoll& a) {
    return fmt::format("[{}, {}, {}]", a.yaw_deg, a.pitch_deg, a.roll_deg);
  }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  static std::string toml(Enum value) { return toml(std::string(enum_name(value))); }
  static std::string toml(const std::string& text) { return toml_string(text); }
  template <typename Range>
  requires requires(const Range& r) {
    r.begin();
  } &&(!std::same_as<Range, fs::path>)&&(!std::same_as<Range, std::string>)static std::string
      toml(const Range& values) {
    std::string result = "[";
    for (const auto& value : values) result += (result.size() > 1 ? ", " : "") + toml(value);
    return result + "]";
  }

  std::string text_;
};

void add_lens(Text& text, const Lens& lens) {
  text.heading("[lens]");
  text.add("file", lens.file);
  if (lens.file) return;
  text.add("model", lens.model);
  text.add("vertical_fov_deg", lens.vertical_fov_deg);
  text.add("focal_px", lens.focal_px);
  text.add("principal_point_px", lens.principal_point_px);
  text.add("distortion", lens.distortion);
}

void add_camera(Text& text, const Camera& camera) {
  text.heading("[camera]");
  text.add("path_file", camera.path_file);
  if (camera.path_file) return;
  text.add("log", camera.log);
  text.add("log_offset_s", camera.log_offset_s);
  if (!camera.log || camera.position_is_stated) text.add("position_ned_m", camera.position_ned_m);
  if (!camera.log) text.add("velocity_ned_mps", camera.velocity_ned_mps);
  text.add("attitude_yaw_pitch_roll_deg", camera.attitude_yaw_pitch_roll_deg);
}

void add_light(Text& text, const Light& light) {
  text.heading("[light]");
  text.add("sun_azimuth_deg", light.sun_azimuth_deg);
  text.add("sun_elevation_deg", light.sun_elevation_deg);
  text.add("exposure", light.exposure);
  text.add("sky_colour", light.sky_colour);
  text.add("ground_colour", light.ground_colour);
  text.add("ground_albedo", light.ground_albedo);
}

bool is_automatic(const CameraModel& model, const CameraKey& key) {
  const auto& automatic = model.automatic;
  return std::ranges::find(automatic, key.name) != automatic.end();
}

// Writes every table, also one without a stated key.
void add_camera_model(Text& text, const CameraModel& model) {
  for (const std::string_view table : kCameraTables) {
    text.heading(fmt::format("[{}]", table));
    for (const CameraKey& key : kCameraModelKeys) {
      if (key.table() != table) continue;
      if (is_automatic(model, key))
        text.add(key.key(), std::string(kAutomaticWord));
      else
        std::visit([&](auto member) { text.add(key.key(), model.*member); }, key.member);
    }
  }
}

void add_weather(Text& text, const Weather& weather) {
  if (!states_any_key(weather)) return;
  text.heading("[weather]");
  for (const WeatherKey& key : kWeatherKeys) text.add(key.name, weather.*key.member);
}

void add_realism(Text& text, const Realism& realism) {
  text.heading("[realism]");
  text.add("file", realism.file);
  text.add("auto", realism.automatic);
  text.add("profile", realism.profile);
  text.add("fallback", realism.fallback);
}

std::string aircraft_text(const std::string& aircraft) {
  return wrapper::is_model_file(aircraft) ? absolute_path(aircraft).string() : aircraft;
}

void add_encounter(Text& text, const Encounter& encounter, std::string_view table) {
  text.heading(fmt::format("[{}.encounter]", table));
  text.add("cpa_time_s", encounter.cpa_time_s);
  text.add("cpa_right_m", encounter.cpa_right_m);
  text.add("cpa_above_m", encounter.cpa_above_m);
  text.add("cpa_ahead_m", encounter.cpa_ahead_m);
  text.add("course_deg", encounter.course_deg);
  text.add("speed_mps", encounter.speed_mps);
  text.add("climb_mps", encounter.climb_mps);
  text.add("turn_rate_dps", encounter.turn_rate_dps);
}

void add_seen(Text& text, const Seen& seen, std::string_view table) {
  text.heading(fmt::format("[[{}.seen]]", table));
  text.add("time_s", seen.time_s);
  text.add("pixel", seen.pixel);
  text.add("range_m", seen.range_m);
  text.add("width_px", seen.width_px);
}

void add_path(Text& text, const Intruder& intruder, std::string_view table) {
  text.add("path_file", intruder.path_file);
  const bool has_tables = intruder.encounter || !intruder.seen.empty();
  if (intruder.position_ned_m) {
    text.add("position_ned_m", *intruder.position_ned_m);
    text.add("velocity_ned_mps", intruder.velocity_ned_mps);
  } else if (!intruder.path_file && !has_tables) {
    text.add("waypoints_ned_m", intruder.waypoints_ned_m);
    text.add("speed_mps", intruder.speed_mps);
    if (!intruder.speed_mps) text.add("times_s", intruder.times_s);
  }
  if (!has_tables && !intruder.position_ned_m) text.add("start_s", intruder.start_s);
  text.add("yaw_deg", intruder.yaw_deg);
  text.add("pitch_deg", intruder.pitch_deg);
  text.add("roll_deg", intruder.roll_deg);
  // Tables come last: a key after them would belong to them.
  if (intruder.encounter) add_encounter(text, *intruder.encounter, table);
  for (const Seen& seen : intruder.seen) add_seen(text, seen, table);
}

void add_intruder(Text& text, const Intruder& intruder) {
  text.heading("[[intruder]]");
  text.add("id", intruder.id);
  text.add("aircraft", aircraft_text(intruder.aircraft));
  text.add("model_forward", intruder.model_forward);
  text.add("model_up", intruder.model_up);
  text.add("model_scale", intruder.model_scale);
  text.add("catalogue_scale", intruder.catalogue_scale);
  if (intruder.spin_time_s != 0) text.add("spin_time_s", intruder.spin_time_s);
  add_path(text, intruder, "intruder");
}

void add_distractor(Text& text, const Intruder& intruder) {
  const Distractor& one = *intruder.distractor;
  text.heading("[[distractor]]");
  text.add("kind", one.kind);
  text.add("id", intruder.id);
  text.add("size_m", one.size_m);
  if (one.kind == DistractorKind::kBird) {
    text.add("plumage", one.plumage);
    text.add("aspect_ratio", one.aspect_ratio);
    text.add("flap_hz", one.flap_hz);
    text.add("flap_phase", one.flap_phase);
    text.add("glide", one.glide);
  } else {
    text.add("colour", one.colour);
  }
  if (one.kind == DistractorKind::kMultirotor) {
    text.add("arm_colour", one.arm_colour);
    text.add("rotors", one.rotors);
  }
  text.add("offset_ned_m", intruder.offset_ned_m);
  add_path(text, intruder, "distractor");
}

void add_mark(Text& text, const LensMark& mark) {
  text.heading("[[distractor]]");
  text.add("kind", mark.kind);
  text.add("id", mark.id);
  if (mark.pixel) {
    text.add("pixel", *mark.pixel);
    text.add("velocity_px_s", mark.velocity_px_s);
  } else {
    text.add("along", mark.along);
  }
  text.add("size_px", mark.size_px);
  text.add("length_px", mark.length_px);
  text.add("softness", mark.softness);
  text.add("opacity", mark.opacity);
  text.add("colour", mark.colour);
  text.add("begin_s", mark.begin_s);
  text.add("end_s", mark.end_s);
}

void add_things(Text& text, const Scene& scene) {
  for (const Intruder& intruder : scene.intruders)
    is_aircraft(intruder) ? add_intruder(text, intruder) : add_distractor(text, intruder);
  for (const LensMark& mark : scene.lens_marks) add_mark(text, mark);
  for (const Occluder& occluder : scene.occluders) {
    text.heading("[[occluder]]");
    text.add("range_m", occluder.range_m);
    text.add("mask", occluder.mask);
    if (occluder.beyond_horizon) text.add("beyond_horizon", true);
  }
}

void add_truth(Text& text, const Truth& truth) {
  text.heading("[truth]");
  text.add("lookahead_s", truth.lookahead_s);
  if (!truth.volumes.empty()) text.add("volumes", truth.volumes);
  for (const TruthVolume& volume : truth.own_volumes) {
    text.heading("[[truth.volume]]");
    text.add("name", volume.name);
    text.add("horizontal_m", volume.horizontal_m);
    text.add("vertical_m", volume.vertical_m);
    text.add("tau_s", volume.tau_s);
    text.add("coaltitude_s", volume.coaltitude_s);
  }
}

}  // namespace

std::vector<StatedFile> stated_files(const Scene& scene) {
  std::vector<StatedFile> files = {{scene.background.video, scene.background.where}};
  const auto add = [&](const std::optional<fs::path>& file, const Where& where) {
    if (file) files.push_back({*file, where});
  };
  add(scene.background.mask, scene.background.where);
  add(scene.realism.file, scene.realism.where);
  add(scene.lens.file, scene.lens.where);
  add(scene.camera.path_file, scene.camera.where);
  add(scene.camera.log, scene.camera.where);
  for (const Intruder& intruder : scene.intruders) add(intruder.path_file, intruder.where);
  for (const Occluder& occluder : scene.occluders) add(occluder.mask, occluder.where);
  return files;
}

std::string toml_from_scene(const Scene& scene) {
  check(scene.seed <= static_cast<std::uint64_t>(INT64_MAX), "a seed fits TOML's 64-bit integers");
  Text text;
  text.add("name", scene.name);
  text.add("seed", static_cast<std::int64_t>(scene.seed));
  text.add("weight", scene.weight);
  text.heading("[background]");
  text.add("video", scene.background.video);
  if (!scene.background.name.empty()) text.add("name", scene.background.name);
  text.add("mask", scene.background.mask);
  text.add("first_frame", scene.background.first_frame);
  text.add("frame_count", scene.background.frame_count);
  text.add("frame_rate_hz", scene.background.frame_rate_hz);
  add_lens(text, scene.lens);
  add_camera(text, scene.camera);
  text.heading("[motion]");
  text.add("model", scene.motion.model);
  text.add("reference", scene.motion.reference);
  text.add("smoothing_s", scene.motion.smoothing_s);
  add_light(text, scene.light);
  add_things(text, scene);
  add_camera_model(text, scene.camera_model);
  add_weather(text, scene.weather);
  add_realism(text, scene.realism);
  add_truth(text, scene.truth);
  text.heading("[render]");
  text.add("quality", scene.render.quality);
  text.heading("[composite]");
  text.add("method", scene.composite.method);
  text.heading("[output]");
  text.add("video", scene.output.video);
  text.add("quality", scene.output.quality);
  text.add("keyframe_s", scene.output.keyframe_s);
  text.add("encoder", scene.output.encoder);
  text.add("masks", scene.output.masks);
  return text.take();
}

std::string toml_from_camera_model(const CameraModel& model) {
  Text text;
  add_camera_model(text, model);
  return text.take();
}

}  // namespace airtruth::scene
