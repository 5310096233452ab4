// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "base/files.h"
#include "scene/parse_intruder.h"
#include "scene/scene.h"
#include "scene/table_reader.h"
#include "scene/toml_guard.h"

namespace airtruth::scene {
namespace {

constexpr std::size_t kLargestFile = std::size_t{16} << 20;
constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();

toml::table table_of(std::string_view text, const std::string& file) {
  if (text.size() > kLargestFile)
    throw Error(fmt::format("is {} bytes long; expected a scene of at most 16 MiB", text.size()),
                {file});
  if (const std::size_t fault = utf8_fault(text); fault != std::string_view::npos) {
    const auto newlines =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(fault), '\n');
    throw Error("is not UTF-8; expected a text file in UTF-8",
                {file, static_cast<int>(newlines) + 1, 0});
  }
  refuse_deep_nesting(text, file);
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    std::string reason(error.description());
    std::replace_if(
        reason.begin(), reason.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    const auto begin = error.source().begin;
    throw Error("is not TOML: " + reason,
                {file, static_cast<int>(begin.line), static_cast<int>(begin.column)});
  }
}

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
  background.mask = table.path("mask");
  background.first_frame = table.whole("first_frame", 0, kLargest).value_or(0);
  background.frame_count = table.whole("frame_count", 1, kLargest);
  return background;
}

Limits view_limits(const std::string& model) {
  if (model == "fisheye")
    return {.expected = "degrees above 0, up to 360 for a fisheye",
            .low = 0,
            .high = 360,
            .without_low = true};
  return {.expected = "degrees between 0 and 180 (a fisheye reaches further)",
          .low = 0,
          .high = 180,
          .without_low = true,
          .without_high = true};
}

std::optional<std::array<double, 2>> pair_from(const TableReader& table,
                                               std::string_view key,
                                               const Limits& limits) {
  const auto values = table.tuple(key, {limits, limits});
  if (!values) return std::nullopt;
  return std::array<double, 2>{(*values)[0], (*values)[1]};
}

void check_distortion(const TableReader& table, const std::string& model, std::size_t count) {
  if (model == "pinhole" && count > 0)
    table.fail("distortion",
               "distortion is not for a pinhole; expected model brown_conrady or fisheye, or no "
               "distortion");
  if (model == "brown_conrady" && count != 0 && count != 4 && count != 5 && count != 8)
    table.fail("distortion",
               fmt::format("distortion has {} numbers; brown_conrady takes 4, 5 or 8", count));
  if (model == "fisheye" && count > 4)
    table.fail("distortion",
               fmt::format("distortion has {} numbers; fisheye takes at most 4", count));
}

Lens lens_from(const TableReader& table) {
  Lens lens;
  lens.where = table.where();
  table.exclude("file",
                {"model", "vertical_fov_deg", "focal_px", "principal_point_px", "distortion"});
  table.exclude("vertical_fov_deg", {"focal_px"});
  lens.file = table.path("file");
  if (lens.file) return lens;
  lens.model = table.choice("model", {"pinhole", "brown_conrady", "fisheye"}).value_or(lens.model);
  lens.vertical_fov_deg = table.number("vertical_fov_deg", view_limits(lens.model));
  lens.focal_px = pair_from(table, "focal_px", kAboveZero);
  lens.principal_point_px = pair_from(table, "principal_point_px", kFinite);
  lens.distortion = table.numbers("distortion").value_or(std::vector<double>{});
  check_distortion(table, lens.model, lens.distortion.size());
  if (!lens.vertical_fov_deg && !lens.focal_px)
    throw Error("[lens] has no focal length; expected vertical_fov_deg, focal_px or file",
                table.where());
  return lens;
}

Camera camera_from(const TableReader& table) {
  Camera camera;
  camera.where = table.where();
  table.exclude("path_file", {"position_ned_m", "velocity_ned_mps", "attitude_yaw_pitch_roll_deg"});
  camera.path_file = table.path("path_file");
  camera.position_ned_m = table.vector("position_ned_m").value_or(camera.position_ned_m);
  camera.velocity_ned_mps = table.vector("velocity_ned_mps").value_or(camera.velocity_ned_mps);
  if (const auto angles = table.tuple("attitude_yaw_pitch_roll_deg", {kTurn, kPitch, kTurn}))
    camera.attitude_yaw_pitch_roll_deg = {(*angles)[0], (*angles)[1], (*angles)[2]};
  return camera;
}

Motion motion_from(const TableReader& table) {
  Motion motion;
  motion.where = table.where();
  motion.model = table.choice("model", {"homography", "none"}).value_or(motion.model);
  motion.reference =
      table.choice("reference", {"first_frame", "smoothed"}).value_or(motion.reference);
  motion.smoothing_s = table.number("smoothing_s", kAboveZero).value_or(motion.smoothing_s);
  return motion;
}

std::optional<std::array<double, 3>> colour_from(const TableReader& table, std::string_view key) {
  const auto values = table.tuple(key, {kNotNegative, kNotNegative, kNotNegative});
  if (!values) return std::nullopt;
  return std::array<double, 3>{(*values)[0], (*values)[1], (*values)[2]};
}

Light light_from(const TableReader& table) {
  Light light;
  light.where = table.where();
  light.sun_azimuth_deg = table.number("sun_azimuth_deg", kTurn).value_or(light.sun_azimuth_deg);
  light.sun_elevation_deg =
      table.number("sun_elevation_deg", kPitch).value_or(light.sun_elevation_deg);
  light.exposure = table.number("exposure", kAboveZero);
  light.sky_colour = colour_from(table, "sky_colour");
  light.ground_colour = colour_from(table, "ground_colour");
  return light;
}

Output output_from(const TableReader& table) {
  Output output;
  output.video = table.choice("video", {"mp4", "mkv", "avi", "png"}).value_or(output.video);
  output.quality = static_cast<int>(table.whole("quality", 0, 51).value_or(output.quality));
  return output;
}

Render render_from(const TableReader& table) {
  Render render;
  render.quality = static_cast<int>(table.whole("quality", 1, 5).value_or(render.quality));
  return render;
}

Composite composite_from(const TableReader& table) {
  Composite composite;
  composite.method = table.choice("method", {"matte", "chroma-key"}).value_or(composite.method);
  return composite;
}

}  // namespace

Scene read_scene(const fs::path& file) { return parse_scene(read_file(file, kLargestFile), file); }

Scene parse_scene(std::string_view text, const fs::path& file) {
  const toml::table parsed = table_of(text, file.string());
  const TableReader root(parsed,
                         "a scene",
                         file.string(),
                         {"name",
                          "seed",
                          "background",
                          "lens",
                          "camera",
                          "motion",
                          "light",
                          "intruder",
                          "render",
                          "composite",
                          "output"});
  Scene scene;
  scene.file = file;
  scene.name = name_of(root, file);
  scene.seed = static_cast<std::uint64_t>(root.whole("seed", 0, kLargest).value_or(1));
  scene.background =
      background_from(root.table("background", {"video", "mask", "first_frame", "frame_count"}));
  scene.lens = lens_from(root.table(
      "lens",
      {"model", "vertical_fov_deg", "focal_px", "principal_point_px", "distortion", "file"}));
  scene.camera = camera_from(root.table(
      "camera",
      {"position_ned_m", "velocity_ned_mps", "attitude_yaw_pitch_roll_deg", "path_file"}));
  scene.motion = motion_from(root.table("motion", {"model", "reference", "smoothing_s"}));
  scene.light = light_from(root.table(
      "light",
      {"sun_azimuth_deg", "sun_elevation_deg", "exposure", "sky_colour", "ground_colour"}));
  scene.intruders = intruders_from(root);
  scene.render = render_from(root.table("render", {"quality"}));
  scene.composite = composite_from(root.table("composite", {"method"}));
  scene.output = output_from(root.table("output", {"video", "quality"}));
  return scene;
}

}  // namespace airtruth::scene
