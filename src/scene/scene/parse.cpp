// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <limits>

#include <fmt/format.h>

#include "foundation/base/files.h"
#include "scene/scene/flock.h"
#include "scene/scene/scene.h"
#include "scene/scene/table_reader.h"
#include "scene/scene/tables.h"

namespace airtruth::scene {
namespace {

// TOML's whole numbers are signed and have 64 bits.
constexpr std::int64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();
// Largest number of a frame: a year at 30 frames/s.
constexpr std::int64_t kMaxFrames = 1'000'000'000;

std::string name_of(const TableReader& root, const fs::path& file) {
  if (const auto name = root.file_name("name")) return *name;
  const std::string stem = file.stem().string();
  if (!is_plain_file_name(stem))
    throw Error("has no name, and none can be made from the file's", {file.string()});
  return stem;
}

Background background_from(const TableReader& table) {
  Background background;
  background.where = table.where();
  const auto video = table.path("video");
  if (!video)
    throw Error("[background] has no video; expected the path of a video file", table.where());
  background.video = *video;
  background.name = table.text("name").value_or("");
  background.mask = table.path("mask");
  background.first_frame = table.whole("first_frame", 0, kMaxFrames).value_or(0);
  background.frame_count = table.whole("frame_count", 1, kMaxFrames);
  background.frame_rate_hz = table.number("frame_rate_hz", kFrameRate_hz);
  return background;
}

}  // namespace

Scene read_scene(const fs::path& file) {
  const bool is_folder = fs::is_directory(file);
  std::ifstream beginning(file, std::ios::binary);
  std::array<char, 4096> bytes{};
  beginning.read(bytes.data(), bytes.size());
  const auto end = bytes.begin() + beginning.gcount();
  // Every container of video has a byte of zero among its first; no text has one.
  if (is_folder || std::find(bytes.begin(), end, '\0') != end)
    throw Error(fmt::format("is {}; expected a scene file (.toml); `airtruth scene new` writes one "
                            "for a video",
                            is_folder ? "a folder" : "no text"),
                {file.string()});
  return parse_scene(read_file(file, kLargestToml), file);
}

Scene parse_scene(std::string_view text, const fs::path& file) {
  const toml::table parsed = parsed_toml(text, file.string());
  const TableReader root(
      parsed,
      "a scene",
      file.string(),
      with_camera_tables(
          {"name", "seed", "weight", "background", "lens", "camera", "motion", "light"},
          keys("weather realism intruder distractor occluder truth render composite "
               "output")));
  Scene scene;
  scene.file = file;
  scene.name = name_of(root, file);
  scene.seed = static_cast<std::uint64_t>(root.whole("seed", 0, kLargestSeed).value_or(1));
  scene.weight = root.number("weight", kWeight);
  scene.background = background_from(root.table(
      "background", {"video", "name", "mask", "first_frame", "frame_count", "frame_rate_hz"}));
  scene.lens = lens_in(root);
  scene.motion = motion_in(root);
  scene.camera = camera_in(root, scene.motion);
  scene.light = light_in(root);
  scene.camera_model = camera_model_in(root);
  scene.weather = weather_in(root);
  scene.realism = realism_in(root);
  scene.intruders = intruders_from(root);
  if (scene.intruders.size() > kMaxThings)
    throw Error(
        fmt::format(
            "has {} tables [[intruder]]; expected at most {}", scene.intruders.size(), kMaxThings),
        scene.intruders[kMaxThings].where);
  add_distractors(root, scene);
  scene.occluders = occluders_in(root);
  static_cast<OutputTables&>(scene) = output_tables_in(root);
  return scene;
}

CameraFile read_camera_file(const fs::path& file) {
  return parse_camera_file(read_file(file, kLargestToml), file);
}

CameraFile parse_camera_file(std::string_view text, const fs::path& file) {
  const toml::table parsed = parsed_toml(text, file.string());
  const TableReader root(parsed,
                         "a camera file",
                         file.string(),
                         with_camera_tables({"clip"}, {"light", "uncertainty"}));
  CameraFile camera;
  const TableReader clip =
      root.table("clip", {"video", "width", "height", "frames", "lens", "gamma"});
  camera.width = static_cast<int>(clip.whole("width", 1, 1 << 16).value_or(0));
  camera.height = static_cast<int>(clip.whole("height", 1, 1 << 16).value_or(0));
  if (camera.width == 0 || camera.height == 0)
    throw Error("[clip] has no width and height; expected a file that airtruth calibrate wrote",
                clip.where());
  camera.lens = clip.text("lens").value_or("");
  camera.gamma = clip.number("gamma", kGamma);
  camera.model = camera_model_in(root);
  if (!camera.model.automatic.empty())
    throw Error(camera.model.automatic.front() + " is \"auto\"; expected a value in a camera file",
                {file.string()});
  if (camera.model.angle_deg || camera.model.gamma)
    throw Error(std::string("[") +
                    (camera.model.angle_deg ? "shutter] angle_deg is" : "sensor] gamma is") +
                    " not read from a camera file; expected it in the scene",
                {file.string()});
  const TableReader light = root.table("light", {"sun_azimuth_deg", "sun_elevation_deg"});
  camera.sun_azimuth_deg = light.number("sun_azimuth_deg", kTurn);
  camera.sun_elevation_deg = light.number("sun_elevation_deg", kPitch);
  return camera;
}

}  // namespace airtruth::scene
