// SPDX-License-Identifier: Apache-2.0
#include "world/scene/tables.h"

#include <algorithm>

#include <fmt/format.h>

#include "foundation/base/files.h"
#include "foundation/base/line_of.h"
#include "world/scene/toml_guard.h"

namespace airtruth::scene {
namespace {

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

std::optional<std::array<double, 3>> three_from(const TableReader& table,
                                                std::string_view key,
                                                const Limits& each) {
  const auto values = table.tuple(key, {each, each, each});
  if (!values) return std::nullopt;
  return std::array<double, 3>{(*values)[0], (*values)[1], (*values)[2]};
}

}  // namespace

toml::table parsed_toml(std::string_view text, const std::string& file) {
  if (text.size() > kLargestToml)
    throw Error(fmt::format("is {} bytes long; expected at most 16 MiB", text.size()), {file});
  if (const std::size_t fault = utf8_fault(text); fault != std::string_view::npos)
    throw Error("is not UTF-8; expected a text file in UTF-8",
                {file, line_of(text, static_cast<std::ptrdiff_t>(fault))});
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

Lens lens_in(const TableReader& parent) {
  const TableReader table = parent.table(
      "lens",
      {"model", "vertical_fov_deg", "focal_px", "principal_point_px", "distortion", "file"});
  Lens lens;
  lens.where = table.where();
  table.exclude("file",
                {"model", "vertical_fov_deg", "focal_px", "principal_point_px", "distortion"});
  table.exclude("vertical_fov_deg", {"focal_px"});
  lens.file = table.path("file");
  if (lens.file) return lens;
  lens.model = table.choice("model", {"pinhole", "brown_conrady", "fisheye"}).value_or(lens.model);
  lens.vertical_fov_deg =
      table.number("vertical_fov_deg", lens.model == "fisheye" ? kFisheyeView : kPinholeView);
  lens.focal_px = pair_from(table, "focal_px", kFocal);
  lens.principal_point_px = pair_from(table, "principal_point_px", kPrincipalPoint);
  lens.distortion = table.numbers("distortion", kDistortion).value_or(std::vector<double>{});
  check_distortion(table, lens.model, lens.distortion.size());
  if (!lens.vertical_fov_deg && !lens.focal_px)
    throw Error("[lens] has no focal length; expected vertical_fov_deg, focal_px or file",
                table.where());
  return lens;
}

Camera camera_in(const TableReader& parent) {
  const TableReader table = parent.table(
      "camera", {"position_ned_m", "velocity_ned_mps", "attitude_yaw_pitch_roll_deg", "path_file"});
  Camera camera;
  camera.where = table.where();
  table.exclude("path_file", {"position_ned_m", "velocity_ned_mps", "attitude_yaw_pitch_roll_deg"});
  camera.path_file = table.path("path_file");
  camera.position_ned_m = table.vector("position_ned_m", kPosition).value_or(camera.position_ned_m);
  camera.velocity_ned_mps =
      table.vector("velocity_ned_mps", kVelocity).value_or(camera.velocity_ned_mps);
  if (const auto angles = table.tuple("attitude_yaw_pitch_roll_deg", {kTurn, kPitch, kTurn}))
    camera.attitude_yaw_pitch_roll_deg = {(*angles)[0], (*angles)[1], (*angles)[2]};
  return camera;
}

Motion motion_in(const TableReader& parent) {
  const TableReader table = parent.table("motion", {"model", "reference", "smoothing_s"});
  Motion motion;
  motion.where = table.where();
  motion.model =
      table.choice("model", {"auto", "rotation", "homography", "none"}).value_or(motion.model);
  motion.reference =
      table.choice("reference", {"first_frame", "smoothed"}).value_or(motion.reference);
  motion.smoothing_s = table.number("smoothing_s", kSmoothing).value_or(motion.smoothing_s);
  return motion;
}

namespace {

// Reads keys that accept "auto" in place of a value, and lists the keys that hold it.
class AutoReader {
 public:
  AutoReader(const TableReader& table, std::string name, std::vector<std::string>& automatic)
      : table_(table), name_(std::move(name)), automatic_(automatic) {}

  std::optional<double> number(std::string_view key, const Limits& limits) {
    return is_automatic(key) ? std::nullopt : table_.number(key, limits);
  }
  std::optional<std::array<double, 3>> three(std::string_view key, const Limits& each) {
    return is_automatic(key) ? std::nullopt : three_from(table_, key, each);
  }

 private:
  bool is_automatic(std::string_view key) {
    if (!table_.says(key, "auto")) return false;
    automatic_.push_back(name_ + "." + std::string(key));
    return true;
  }

  const TableReader& table_;
  std::string name_;
  std::vector<std::string>& automatic_;
};

}  // namespace

CameraModel camera_model_in(const TableReader& parent) {
  CameraModel model;
  const TableReader shutter =
      parent.table("shutter", {"exposure_s", "angle_deg", "readout_s", "readout"});
  shutter.exclude("exposure_s", {"angle_deg"});
  AutoReader in_shutter(shutter, "shutter", model.automatic);
  model.exposure_s = in_shutter.number("exposure_s", kExposureTime);
  model.angle_deg = shutter.number("angle_deg", kShutterAngle);
  model.readout_s = in_shutter.number("readout_s", kExposureTime);
  model.readout = shutter.choice("readout", {"down", "up", "right", "left"});

  const TableReader air = parent.table("air", {"extinction_per_km", "airlight"});
  AutoReader in_air(air, "air", model.automatic);
  model.extinction_per_km = in_air.three("extinction_per_km", kExtinction);
  model.airlight = in_air.three("airlight", kLinearLight);

  const TableReader optics =
      parent.table("optics", {"point_spread_px", "sharpening", "sharpening_px"});
  AutoReader in_optics(optics, "optics", model.automatic);
  model.point_spread_px = in_optics.number("point_spread_px", kSpread);
  model.sharpening = in_optics.number("sharpening", kSharpening);
  model.sharpening_px = in_optics.number("sharpening_px", kSpread);

  const TableReader sensor = parent.table("sensor",
                                          {"noise_gain",
                                           "noise_floor",
                                           "noise_correlation_px",
                                           "chroma_spread_px",
                                           "codec_step",
                                           "gamma"});
  AutoReader in_sensor(sensor, "sensor", model.automatic);
  model.noise_gain = in_sensor.number("noise_gain", kVariance);
  model.noise_floor = in_sensor.number("noise_floor", kVariance);
  model.noise_correlation_px = in_sensor.number("noise_correlation_px", kSpread);
  model.chroma_spread_px = in_sensor.number("chroma_spread_px", kSpread);
  model.codec_step = in_sensor.number("codec_step", kCodecStep);
  model.gamma = sensor.number("gamma", kGamma);
  return model;
}

Realism realism_in(const TableReader& parent) {
  const TableReader table = parent.table("realism", {"file", "auto", "profile", "fallback"});
  Realism realism;
  realism.where = table.where();
  realism.file = table.path("file");
  realism.automatic = table.truth("auto").value_or(false);
  realism.profile = table.text("profile");
  realism.fallback = table.truth("fallback").value_or(false);
  return realism;
}

Light light_in(const TableReader& parent) {
  const TableReader table = parent.table("light",
                                         {"sun_azimuth_deg",
                                          "sun_elevation_deg",
                                          "exposure",
                                          "sky_colour",
                                          "ground_colour",
                                          "ground_albedo"});
  table.exclude("ground_colour", {"ground_albedo"});
  Light light;
  light.where = table.where();
  light.sun_azimuth_deg = table.number("sun_azimuth_deg", kTurn).value_or(light.sun_azimuth_deg);
  light.sun_elevation_deg =
      table.number("sun_elevation_deg", kPitch).value_or(light.sun_elevation_deg);
  light.sun_is_stated = table.has("sun_azimuth_deg") || table.has("sun_elevation_deg");
  light.exposure = table.number("exposure", kExposureFactor);
  light.sky_colour = three_from(table, "sky_colour", kLinearLight);
  light.ground_colour = three_from(table, "ground_colour", kLinearLight);
  light.ground_albedo = table.number("ground_albedo", kAlbedo);
  return light;
}

Output output_in(const TableReader& parent) {
  const TableReader table = parent.table("output", {"video", "quality", "masks"});
  Output output;
  output.video = table.choice("video", {"mp4", "mkv", "avi", "png"}).value_or(output.video);
  output.quality = static_cast<int>(table.whole("quality", 0, 51).value_or(output.quality));
  output.masks = table.truth("masks").value_or(output.masks);
  return output;
}

Render render_in(const TableReader& parent) {
  const TableReader table = parent.table("render", {"quality"});
  Render render;
  render.quality = static_cast<int>(table.whole("quality", 1, 5).value_or(render.quality));
  return render;
}

Composite composite_in(const TableReader& parent) {
  const TableReader table = parent.table("composite", {"method"});
  Composite composite;
  composite.method = table.choice("method", {"matte", "chroma-key"}).value_or(composite.method);
  return composite;
}

}  // namespace airtruth::scene
