// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/from_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "camera/lens/calibration_file.h"
#include "encounter/placement/by_approach.h"
#include "foundation/base/names.h"
#include "picture/video/metadata.h"
#include "picture/video/reader.h"
#include "scene/flight_log/local_path.h"
#include "scene/flight_log/log_rates.h"
#include "scene/trajectory/heading.h"

namespace airtruth::setup {
namespace {

lens::Lens stated_lens(const scene::Lens& lens, lens::ImageSize size) {
  const Pixel focal = lens.focal_px.value_or(Pixel(0, 0));
  const Pixel centre = lens.principal_point_px.value_or(Pixel(size.width / 2.0, size.height / 2.0));
  lens::Facts facts{enum_name(lens.model),
                    {focal.x(), focal.y()},
                    {centre.x(), centre.y()},
                    lens.distortion,
                    size.width,
                    size.height};
  if (facts.distortion.size() < 4) facts.distortion.resize(4, 0.0);
  if (lens.vertical_fov_deg) {
    const lens::Lens plain = lens.model == lens::ModelKind::kFisheye
                                 ? lens::fisheye_from_vertical_fov(*lens.vertical_fov_deg, size)
                                 : lens::pinhole_from_vertical_fov(*lens.vertical_fov_deg, size);
    facts.focal_px = {plain.focal_px(), plain.focal_px()};
  }
  return lens::lens_of(facts);
}

// An MP4 file has "ftyp" as its first box (ISO/IEC 14496-12, 4.3).
bool is_mp4(const std::filesystem::path& path) {
  std::string head(8, '\0');
  std::ifstream(path, std::ios::binary)
      .read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.substr(4) == "ftyp";
}

flight_log::FlightLog log_in_video(const std::filesystem::path& path) {
  flight_log::FlightLog log;
  log.format = flight_log::Format::kGpmf;
  log.is_on_video_clock = true;
  const auto packets = video::read_telemetry(path);
  for (const video::TelemetryPacket& packet : packets)
    flight_log::add_gpmf_packet(log, packet.bytes, packet.begin_s, packet.end_s);
  const auto subtitles =
      packets.empty() ? video::read_subtitles(path) : std::vector<video::Subtitle>();
  if (!subtitles.empty()) log.format = flight_log::Format::kDjiSubtitles;
  for (const video::Subtitle& subtitle : subtitles)
    flight_log::add_dji_subtitle(log, subtitle.text, subtitle.begin_s, path.string());
  if (packets.empty() && subtitles.empty())
    throw Error(
        "is a video without a GoPro's telemetry and without subtitles; expected a flight log",
        {path.string()});
  log = flight_log::without_jumps(std::move(log), path.string());
  if (log.fixes.size() < 2)
    throw Error(fmt::format("holds {} positions with a fix ({} without); expected at least two",
                            log.fixes.size(),
                            log.left_out),
                {path.string()});
  return log;
}

double offset_of(const scene::Camera& camera, const flight_log::FlightLog& log) {
  if (camera.log_offset_s) return *camera.log_offset_s;
  if (log.is_on_video_clock) return camera.clip_start_s;
  throw Error(fmt::format("the log ({}) has a clock of its own; expected log_offset_s, {}",
                          flight_log::name(log.format),
                          flight_log::gyro_samples(log).size() < 2
                              ? "its time at the first frame that the scene uses"
                              : "which 'airtruth log align' finds"),
              camera.where);
}

using HeadingDeg = std::function<double(const trajectory::State&, double time_s)>;

// The heading of a log's path, held where measured positions are too slow to tell it.
HeadingDeg heading_along(const trajectory::Path& path) {
  // Positions are means of half seconds.
  constexpr double kStepS = 0.5;
  std::vector<double> times_s;
  for (double time_s = path.start_s(); time_s < path.end_s(); time_s += kStepS)
    times_s.push_back(time_s);
  times_s.push_back(path.end_s());
  const auto heading = std::make_shared<const trajectory::Heading>(
      [path](double time_s) { return path.at(time_s)->velocity_in_world_mps; },
      std::move(times_s),
      trajectory::kMeasuredCourseMps);
  return [heading](const trajectory::State& state, double time_s) {
    return heading->is_slow(state.velocity_in_world_mps)
               ? heading->held_deg_at(time_s).value_or(0)
               : yaw_pitch_roll(state.world_from_body).yaw_deg;
  };
}

// The path with that attitude at the first frame, turned from there as the log's attitudes turn, or
// as a level aircraft along its path where the log has none.
trajectory::Path turning(const trajectory::Path& path,
                         const YawPitchRoll& first,
                         bool has_attitudes,
                         const HeadingDeg& heading_deg) {
  const auto flown = [has_attitudes, heading_deg](const trajectory::State& state, double time_s) {
    if (has_attitudes) return state.world_from_body;
    return world_from_body({heading_deg(state, time_s), 0, 0});
  };
  const Quaternion mount = flown(*path.at(0), 0).conjugate() * world_from_body(first);
  return trajectory::at_attitudes(
      path, [flown, mount](const trajectory::State& state, double time_s) -> Quaternion {
        return flown(state, time_s) * mount;
      });
}

trajectory::Path path_from_file(const scene::Camera& camera) {
  const trajectory::Path path = trajectory::read_path_file(*camera.path_file);
  const auto first = path.at(0);
  if (camera.follows_attitude || !first) return path;
  return trajectory::at_attitude(path, yaw_pitch_roll(first->world_from_body));
}

trajectory::Path path_from_log(const scene::Camera& camera, const Warn& warn) {
  flight_log::FlightLog log = read_log(*camera.log);
  if (!log.first_fault.empty())
    airtruth::warn(warn,
                   fmt::format("{}: {} records are left out (the first with a fault: {})",
                               camera.log->string(),
                               log.left_out,
                               log.first_fault));
  const double offset_s = offset_of(camera, log);
  Vector3 first = camera.position_ned_m;
  if (!camera.position_is_stated)
    if (const auto height_m = flight_log::height_at(log, offset_s)) first = {0, 0, -*height_m};
  const flight_log::Placement placement{offset_s, first};
  if (camera.attitude_yaw_pitch_roll_deg && !camera.follows_attitude) log.attitudes.clear();
  try {
    const trajectory::Path path = flight_log::local_path(log, placement);
    const bool has_attitudes = !log.attitudes.empty();
    if (camera.follows_attitude && has_attitudes && !camera.attitude_yaw_pitch_roll_deg)
      return path;
    const HeadingDeg heading_deg = heading_along(path);
    auto attitude = camera.attitude_yaw_pitch_roll_deg;
    if (!attitude) attitude = flight_log::attitude_at(log, offset_s);
    if (!attitude) attitude = {heading_deg(*path.at(0), 0), 0, 0};
    if (camera.follows_attitude) return turning(path, *attitude, has_attitudes, heading_deg);
    log.attitudes.clear();  // only that of the first frame counts
    return trajectory::at_attitude(flight_log::local_path(log, placement), *attitude);
  } catch (const Error& error) {
    throw Error(error.message(), camera.where);
  }
}

}  // namespace

lens::Lens lens_of(const scene::Lens& lens, lens::ImageSize size, const Warn& warn) {
  return at_place(lens.where, [&] {
    return lens.file ? lens::read_calibration(*lens.file, size, warn) : stated_lens(lens, size);
  });
}

void take_pixel_shape(scene::Lens& lens, lens::ImageSize size, double width_of_height) {
  if (!lens.vertical_fov_deg || !(width_of_height > 0) || width_of_height == 1) return;
  const double focal_px = lens_of(lens, size).focal_px();
  lens.focal_px = {focal_px / width_of_height, focal_px};
  lens.vertical_fov_deg.reset();
}

void state_clip_start(scene::Camera& camera,
                      const std::filesystem::path& video,
                      std::int64_t first_frame,
                      const std::optional<double>& picture_rate_hz) {
  if (camera.log && !camera.log_offset_s)
    camera.clip_start_s = video::time_of_first_frame_s(
        video, {.first_frame = first_frame, .picture_rate_hz = picture_rate_hz});
}

trajectory::Path camera_path(const scene::Camera& camera, const Warn& warn) {
  if (camera.path_file) return path_from_file(camera);
  if (camera.log) return path_from_log(camera, warn);
  return trajectory::uniform(camera.position_ned_m,
                             camera.velocity_ned_mps,
                             camera.attitude_yaw_pitch_roll_deg.value_or(YawPitchRoll{}));
}

void warn_of_hover(const scene::Camera& camera, const Warn& warn) {
  const bool is_stated = camera.attitude_yaw_pitch_roll_deg.has_value();
  if (!camera.log || (is_stated && !camera.follows_attitude)) return;
  const trajectory::State first = *camera_path(camera).at(0);
  if (first.velocity_in_world_mps.head<2>().norm() > trajectory::kMeasuredCourseMps ||
      !read_log(*camera.log).attitudes.empty())
    return;
  airtruth::warn(
      warn,
      fmt::format(
          "{}: at the first frame the aircraft is slower than {:g} m/s, too slow for a path "
          "without attitudes to tell its heading: {}",
          camera.log->string(),
          trajectory::kMeasuredCourseMps,
          is_stated ? "the stated attitude is held until it flies"
                    : fmt::format("the yaw is {:.0f} degrees, from the flight before or "
                                  "after, else north; expected "
                                  "attitude_yaw_pitch_roll_deg",
                                  yaw_pitch_roll(first.world_from_body).yaw_deg)));
}

trajectory::Path unmeasured_camera_path(scene::Camera camera) {
  camera.follows_attitude = true;
  return camera_path(camera);
}

namespace {

// Nose down for each metre a second of a multirotor's speed over the ground, and at most: a camera
// drone leans by 25 to 35 degrees at its greatest speed, 16 to 20 m/s, and climbs level.
constexpr double kLeanDegPerMps = 1.6;
constexpr double kMostLeanDeg = 30;

// The speed of an intruder over the ground, over its whole path, as far as its scene states it.
double stated_ground_mps(const scene::Intruder& intruder) {
  if (intruder.position_ned_m) return intruder.velocity_ned_mps.head<2>().norm();
  if (const auto& encounter = intruder.encounter)
    return std::sqrt(std::pow(encounter->speed_mps, 2) - std::pow(encounter->climb_mps, 2));
  if (intruder.waypoints_ned_m.size() < 2) return 0;
  double length_m = 0, over_ground_m = 0;
  for (std::size_t i = 1; i < intruder.waypoints_ned_m.size(); ++i) {
    const Vector3 step = intruder.waypoints_ned_m[i] - intruder.waypoints_ned_m[i - 1];
    length_m += step.norm();
    over_ground_m += step.head<2>().norm();
  }
  return over_ground_m / (intruder.speed_mps ? length_m / *intruder.speed_mps
                                             : intruder.times_s.back() - intruder.times_s.front());
}

// A balloon hangs upright and a multirotor leans into its flight, whatever way the path goes.
trajectory::AttitudeOverride attitude_of(const scene::Intruder& intruder) {
  trajectory::AttitudeOverride attitude{intruder.yaw_deg, intruder.pitch_deg, intruder.roll_deg};
  if (scene::is_aircraft(intruder) || intruder.distractor->kind == scene::DistractorKind::kBird)
    return attitude;
  const bool leans = intruder.distractor->kind == scene::DistractorKind::kMultirotor;
  const double lean_deg =
      leans ? std::min(kMostLeanDeg, kLeanDegPerMps * stated_ground_mps(intruder)) : 0;
  if (!attitude.pitch_deg) attitude.pitch_deg = -lean_deg;
  if (!attitude.roll_deg) attitude.roll_deg = 0;
  return attitude;
}

// Steady flight from a place; its nose points along the velocity.
trajectory::Path drift_of(const scene::Intruder& intruder) {
  const trajectory::AttitudeOverride stated = attitude_of(intruder);
  const Vector3& v = intruder.velocity_ned_mps;
  const double along_deg = v.head<2>().norm() > 0 ? degrees(std::atan2(v.y(), v.x())) : 0;
  const double climb_deg = v.norm() > 0 ? degrees(std::atan2(-v.z(), v.head<2>().norm())) : 0;
  return trajectory::uniform(*intruder.position_ned_m,
                             v,
                             {stated.yaw_deg.value_or(along_deg),
                              stated.pitch_deg.value_or(climb_deg),
                              stated.roll_deg.value_or(0)});
}

// Flight through the samples of a path_file: its angles give way to the scene's own, and the usual
// ones of a balloon or a multirotor to both.
trajectory::Path sampled_path(scene::Intruder intruder) {
  trajectory::Samples samples = trajectory::read_path_samples(*intruder.path_file);
  if (intruder.yaw_deg) samples.has_angle[0] = false;
  if (intruder.pitch_deg) samples.has_angle[1] = false;
  if (intruder.roll_deg) samples.has_angle[2] = false;
  intruder.waypoints_ned_m = samples.positions_ned_m;
  intruder.times_s = samples.times_s;
  return trajectory::path_through_samples(samples, attitude_of(intruder));
}

trajectory::Path flown_path(const scene::Intruder& intruder, const trajectory::Path& own) {
  if (intruder.position_ned_m) return drift_of(intruder);
  const trajectory::AttitudeOverride attitude = attitude_of(intruder);
  if (intruder.encounter) return placement::path_to_approach(*intruder.encounter, own, attitude);
  return at_place(intruder.where, [&] {
    const trajectory::Path path =
        intruder.path_file ? sampled_path(intruder)
        : intruder.speed_mps
            ? trajectory::spline_at_speed(intruder.waypoints_ned_m, *intruder.speed_mps, attitude)
            : trajectory::spline_at_times(intruder.waypoints_ned_m, intruder.times_s, attitude);
    return intruder.start_s == 0 ? path : trajectory::shifted(path, intruder.start_s);
  });
}

}  // namespace

trajectory::Path path_of(const scene::Intruder& intruder, const trajectory::Path& own) {
  check(intruder.seen.empty(), "an intruder that is given by what is seen has been placed");
  const trajectory::Path path = flown_path(intruder, own);
  return intruder.offset_ned_m.isZero(0) ? path
                                         : trajectory::displaced(path, intruder.offset_ned_m);
}

std::vector<separation::AskedVolume> volumes_of(const scene::Truth& truth) {
  std::vector<separation::AskedVolume> result;
  for (const std::string& name : truth.volumes) {
    const separation::NamedVolume* known = separation::named_volume(name);
    if (known == nullptr)
      throw Error(fmt::format("[truth] volumes has '{}', which is unknown{}; expected {}",
                              name,
                              did_you_mean(name, separation::volume_names()),
                              fmt::join(separation::volume_names(), ", ")),
                  truth.where);
    result.push_back({name, known->volume});
  }
  for (const scene::TruthVolume& own : truth.own_volumes) {
    if (separation::named_volume(own.name) != nullptr)
      throw Error(fmt::format("[[truth.volume]] has the name '{}' of a known volume; expected "
                              "another name",
                              own.name),
                  truth.where);
    result.push_back({own.name, {own.horizontal_m, own.vertical_m, own.tau_s, own.coaltitude_s}});
  }
  return result;
}

Vector3 to_sun_in_world(const scene::Light& light) {
  return unit_vector(light.sun_azimuth_deg, light.sun_elevation_deg);
}

Shutter shutter_of(const scene::CameraModel& model) {
  check(!model.angle_deg && model.automatic.empty(), "the camera model is resolved");
  return {model.exposure_s.value_or(0),
          model.readout_s.value_or(0),
          model.readout.value_or(Readout::kDown)};
}

image::ToneCurve tone_of(const scene::CameraModel& model) { return {model.gamma.value_or(0)}; }

scene::CameraModel camera_in_weather(const scene::Scene& scene) {
  scene::CameraModel model = scene.camera_model;
  const auto scale = [](std::optional<double>& value, double factor) {
    if (value) *value *= factor;
  };
  scale(model.point_spread_px, scene.weather.blur.value_or(1));
  scale(model.vertical_spread_px, scene.weather.blur.value_or(1));
  const double noise = scene.weather.noise.value_or(1);
  scale(model.noise_gain, noise * noise);
  scale(model.noise_floor, noise * noise);
  return model;
}

composite::Sensor sensor_of(const scene::CameraModel& model) {
  return {.sharpening = model.sharpening.value_or(0),
          .sharpening_px = model.sharpening_px.value_or(composite::Sensor().sharpening_px),
          .noise_gain = model.noise_gain.value_or(0),
          .noise_floor = model.noise_floor.value_or(0),
          .noise_correlation_px = model.noise_correlation_px.value_or(0),
          .tone = tone_of(model),
          .chroma_spread_px = model.chroma_spread_px.value_or(0)};
}

bool has_codec(const scene::CameraModel& model) { return model.codec_step.value_or(0) > 0; }

void warn_of_gaps(const scene::Camera& camera, double clip_s, const Warn& warn) {
  // Receivers record once a second or more often, and miss one or two.
  constexpr double kLongGapS = 3;
  if (!camera.log) return;
  const flight_log::FlightLog log = read_log(*camera.log);
  const double begin_s = offset_of(camera, log);
  const auto look = [&](const auto& records, const char* what, double end_s) {
    const auto gaps = flight_log::gaps(records, kLongGapS, begin_s, end_s);
    if (gaps.empty()) return;
    const auto longest = std::ranges::max_element(gaps, {}, &flight_log::Gap::length_s);
    airtruth::warn(
        warn,
        fmt::format(
            "{}: the clip of about {:.1f} s lies over {} in the log's {} (the longest from {:.2f} "
            "to {:.2f} s "
            "of the log, {:.2f} to {:.2f} s of the clip), across which they are interpolated",
            camera.log->string(),
            clip_s,
            gaps.size() == 1 ? "a gap" : fmt::format("{} gaps", gaps.size()),
            what,
            longest->from_s,
            longest->to_s,
            longest->from_s - begin_s,
            longest->to_s - begin_s));
  };
  look(log.fixes, "positions", begin_s + clip_s);
  if (camera.follows_attitude || !camera.attitude_yaw_pitch_roll_deg)
    look(log.attitudes, "attitudes", begin_s + (camera.follows_attitude ? clip_s : 0));
}

flight_log::FlightLog read_log(const std::filesystem::path& path) {
  return is_mp4(path) ? log_in_video(path) : flight_log::read_flight_log(path);
}

}  // namespace airtruth::setup
