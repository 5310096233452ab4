// SPDX-License-Identifier: Apache-2.0
#include "scene/scene/tables.h"

#include <algorithm>
#include <array>
#include <set>
#include <type_traits>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "scene/scene/camera_keys.h"
#include "scene/scene/table_reader.h"

namespace airtruth::scene {
namespace {

void check_distortion(const TableReader& table, lens::ModelKind model, std::size_t count) {
  if (model == lens::ModelKind::kPinhole && count > 0)
    table.fail("distortion",
               "distortion is not for a pinhole; expected model brown_conrady or fisheye, or no "
               "distortion");
  if (model == lens::ModelKind::kBrownConrady && count != 0 && count != 4 && count != 5 &&
      count != 8)
    table.fail("distortion",
               fmt::format("distortion has {} numbers; brown_conrady takes 4, 5 or 8", count));
  if (model == lens::ModelKind::kFisheye && count > 4)
    table.fail("distortion",
               fmt::format("distortion has {} numbers; fisheye takes at most 4", count));
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
    std::ranges::replace_if(reason, is_control, ' ');
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
  lens.model = table.choice<lens::ModelKind>("model").value_or(lens.model);
  lens.vertical_fov_deg = table.number(
      "vertical_fov_deg", lens.model == lens::ModelKind::kFisheye ? kFisheyeView : kPinholeView);
  lens.focal_px = table.tuple<Pixel>("focal_px", kFocal);
  lens.principal_point_px = table.tuple<Pixel>("principal_point_px", kPrincipalPoint);
  lens.distortion = table.numbers("distortion", kDistortion).value_or(std::vector<double>{});
  check_distortion(table, lens.model, lens.distortion.size());
  if (!lens.vertical_fov_deg && !lens.focal_px)
    throw Error("[lens] has no focal length; expected vertical_fov_deg, focal_px or file",
                table.where());
  return lens;
}

Camera camera_in(const TableReader& parent, const Motion& motion) {
  const TableReader table =
      parent.table("camera",
                   keys("position_ned_m velocity_ned_mps attitude_yaw_pitch_roll_deg path_file "
                        "log log_offset_s"));
  Camera camera;
  camera.where = table.where();
  table.exclude("path_file", {"position_ned_m", "velocity_ned_mps", "attitude_yaw_pitch_roll_deg"});
  camera.path_file = table.path("path_file");
  table.exclude("log", {"path_file", "velocity_ned_mps"});
  camera.log = table.path("log");
  camera.log_offset_s = table.number("log_offset_s", kLogTime);
  camera.position_is_stated = table.has("position_ned_m");
  if (!camera.log && camera.log_offset_s)
    table.fail("log_offset_s", "log_offset_s is stated without a log; expected log as well");
  camera.follows_attitude =
      motion.reference == MotionReference::kSmoothed || motion.model == MotionModel::kNone;
  camera.position_ned_m =
      table.tuple<Vector3>("position_ned_m", kPosition).value_or(camera.position_ned_m);
  camera.velocity_ned_mps =
      table.tuple<Vector3>("velocity_ned_mps", kVelocity).value_or(camera.velocity_ned_mps);
  if (const auto angles = table.tuple("attitude_yaw_pitch_roll_deg", {kTurn, kPitch, kTurn}))
    camera.attitude_yaw_pitch_roll_deg = YawPitchRoll{(*angles)[0], (*angles)[1], (*angles)[2]};
  return camera;
}

Motion motion_in(const TableReader& parent) {
  const TableReader table = parent.table("motion", {"model", "reference", "smoothing_s"});
  Motion motion;
  motion.where = table.where();
  motion.model = table.choice<MotionModel>("model").value_or(motion.model);
  motion.reference = table.choice<MotionReference>("reference").value_or(motion.reference);
  motion.smoothing_s = table.number("smoothing_s", kSmoothing).value_or(motion.smoothing_s);
  return motion;
}

namespace {

TableReader::Keys keys_of_table(std::string_view table) {
  TableReader::Keys keys;
  for (const CameraKey& key : kCameraModelKeys)
    if (key.table() == table) keys.push_back(key.key());
  return keys;
}

template <typename Value>
void read(const TableReader& table, const CameraKey& key, std::optional<Value>& value) {
  if constexpr (std::is_same_v<Value, double>)
    value = table.number(key.key(), key.limits);
  else if constexpr (std::is_same_v<Value, Readout>)
    value = table.choice<Readout>(key.key());
  else
    value = table.tuple<Value>(key.key(), key.limits);
}

}  // namespace

CameraModel camera_model_in(const TableReader& parent) {
  CameraModel model;
  for (const std::string_view name : kCameraTables) {
    const TableReader table = parent.table(name, keys_of_table(name));
    for (const CameraKey& key : kCameraModelKeys)
      if (key.table() == name && !key.excluded_by.empty())
        table.exclude(key.excluded_by, {key.key()});
    for (const CameraKey& key : kCameraModelKeys) {
      if (key.table() != name) continue;
      if (key.is_measured && table.says(key.key(), kAutomaticWord))
        model.automatic.emplace_back(key.name);
      else
        std::visit([&](auto member) { read(table, key, model.*member); }, key.member);
    }
  }
  return model;
}

TableReader::Keys with_camera_tables(TableReader::Keys before, const TableReader::Keys& after) {
  before.insert(before.end(), kCameraTables.begin(), kCameraTables.end());
  before.insert(before.end(), after.begin(), after.end());
  return before;
}

Weather weather_in(const TableReader& parent) {
  TableReader::Keys names;
  for (const WeatherKey& key : kWeatherKeys) names.emplace_back(key.name);
  const TableReader table = parent.table("weather", names);
  Weather weather;
  weather.where = table.where();
  for (const WeatherKey& key : kWeatherKeys)
    weather.*key.member = table.number(key.name, key.limits);
  return weather;
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
  const TableReader table =
      parent.table("light",
                   keys("sun_azimuth_deg sun_elevation_deg exposure sky_colour ground_colour "
                        "ground_albedo"));
  table.exclude("ground_colour", {"ground_albedo"});
  Light light;
  light.sun_azimuth_deg = table.number("sun_azimuth_deg", kTurn).value_or(light.sun_azimuth_deg);
  light.sun_elevation_deg =
      table.number("sun_elevation_deg", kPitch).value_or(light.sun_elevation_deg);
  light.sun_is_stated = table.has("sun_azimuth_deg") || table.has("sun_elevation_deg");
  light.exposure = table.number("exposure", kExposureFactor);
  light.sky_colour = table.tuple<std::array<double, 3>>("sky_colour", kLinearLight);
  light.ground_colour = table.tuple<std::array<double, 3>>("ground_colour", kLinearLight);
  light.ground_albedo = table.number("ground_albedo", kAlbedo);
  return light;
}

std::vector<Occluder> occluders_in(const TableReader& parent) {
  // Each still mask takes a byte for each pixel of the frame.
  constexpr std::size_t kMost = 32;
  std::vector<Occluder> occluders;
  for (const TableReader& table :
       parent.tables("occluder", {"range_m", "mask", "beyond_horizon"})) {
    const auto range_m = table.number("range_m", kRangeToAircraft);
    Occluder occluder{
        0, table.path("mask"), table.truth("beyond_horizon").value_or(false), table.where()};
    if (!range_m)
      throw Error("[[occluder]] has no range_m; expected its distance, beyond which it hides",
                  table.where());
    if (occluder.mask.has_value() == occluder.beyond_horizon)
      throw Error(occluder.mask
                      ? "[[occluder]] has a mask and beyond_horizon; expected one of them"
                      : "[[occluder]] has no mask; expected mask, or beyond_horizon = true",
                  table.where());
    if (occluders.size() == kMost)
      throw Error(fmt::format("more than {} [[occluder]] tables; expected at most so many", kMost),
                  table.where());
    occluder.range_m = *range_m;
    occluders.push_back(std::move(occluder));
  }
  return occluders;
}

namespace {

void take_encoder(Output& output, const TableReader& table) {
  if (!table.has("encoder")) return;
  output.encoder = table.choice<image::VideoEncoder>("encoder").value_or(output.encoder);
  output.encoder_where = table.where("encoder");
  const bool is_hardware =
      output.encoder != image::VideoEncoder::kX264 && output.encoder != image::VideoEncoder::kAuto;
  if (is_hardware && output.video != image::VideoFormat::kMp4)
    throw Error(std::string("encoder is ") + enum_name(output.encoder) +
                    ", which writes H.264; expected video = \"mp4\"",
                output.encoder_where);
}

TruthVolume truth_volume_from(const TableReader& table) {
  TruthVolume volume;
  const auto name = table.file_name("name");
  const auto horizontal_m = table.number("horizontal_m", kThreshold);
  const auto vertical_m = table.number("vertical_m", kThreshold);
  if (!name || !horizontal_m || !vertical_m)
    throw Error(
        fmt::format("[[truth.volume]] has no {}; expected name, horizontal_m and vertical_m",
                    !name           ? "name"
                    : !horizontal_m ? "horizontal_m"
                                    : "vertical_m"),
        table.where());
  volume.name = *name;
  volume.horizontal_m = *horizontal_m;
  volume.vertical_m = *vertical_m;
  volume.tau_s = table.number("tau_s", kThresholdTime).value_or(0);
  volume.coaltitude_s = table.number("coaltitude_s", kThresholdTime).value_or(0);
  return volume;
}

Truth truth_in(const TableReader& parent) {
  const TableReader table = parent.table("truth", {"volumes", "volume", "lookahead_s"});
  Truth truth;
  truth.where = table.where();
  truth.volumes = table.texts("volumes").value_or(std::vector<std::string>{});
  std::set<std::string> taken;
  for (const std::string& name : truth.volumes)
    if (!taken.insert(name).second)
      table.fail("volumes", fmt::format("volumes has '{}' twice; expected each once", name));
  for (const TableReader& own :
       table.tables("volume", {"name", "horizontal_m", "vertical_m", "tau_s", "coaltitude_s"})) {
    truth.own_volumes.push_back(truth_volume_from(own));
    const std::string& name = truth.own_volumes.back().name;
    if (!taken.insert(name).second)
      own.fail("name", fmt::format("name '{}' is taken by another volume; expected another", name));
  }
  truth.lookahead_s = table.number("lookahead_s", kLookahead).value_or(truth.lookahead_s);
  return truth;
}

Output output_in(const TableReader& parent) {
  const TableReader table =
      parent.table("output", {"video", "quality", "keyframe_s", "encoder", "masks"});
  Output output;
  output.video = table.choice<image::VideoFormat>("video").value_or(output.video);
  output.quality = static_cast<int>(table.whole("quality", 0, 51).value_or(output.quality));
  output.keyframe_s = table.number("keyframe_s", kKeyframeSpacing).value_or(output.keyframe_s);
  take_encoder(output, table);
  output.masks = table.truth("masks").value_or(output.masks);
  return output;
}

}  // namespace

OutputTables output_tables_in(const TableReader& parent) {
  OutputTables tables;
  tables.truth = truth_in(parent);
  const TableReader render = parent.table("render", {"quality"});
  int& quality = tables.render.quality;
  quality = static_cast<int>(render.whole("quality", 1, 5).value_or(quality));
  CompositeMethod& method = tables.composite.method;
  method = parent.table("composite", {"method"}).choice<CompositeMethod>("method").value_or(method);
  tables.output = output_in(parent);
  return tables;
}

}  // namespace airtruth::scene
