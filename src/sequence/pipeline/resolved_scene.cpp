// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/resolved_scene.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "calibration/camera_file/cache.h"
#include "calibration/camera_file/calibrate.h"
#include "calibration/camera_file/profile.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "scene/scene/camera_keys.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/level_camera.h"
#include "sequence/setup/steady_camera.h"

namespace airtruth::pipeline {
namespace {

scene::CameraFile file_of(const scene::Scene& scene, const lens::ImageSize& size) {
  const fs::path& path = *scene.realism.file;
  const scene::CameraFile file = scene::read_camera_file(path);
  if (file.width != size.width || file.height != size.height)
    throw Error(fmt::format("was measured on a clip of {} x {} px; the background is {} x {}",
                            file.width,
                            file.height,
                            size.width,
                            size.height),
                {path.string()});
  const std::string lens = camera_file::lens_words(setup::lens_of(scene.lens, size));
  if (!file.lens.empty() && file.lens != lens)
    throw Error("was measured through the lens '" + file.lens + "'; the scene's is '" + lens +
                    "'; expected the calibration of `airtruth calibrate --lens` as [lens] file",
                {path.string()});
  if (scene.camera_model.gamma && scene.camera_model.gamma != file.gamma)
    throw Error(fmt::format("was measured with {}; the scene's is {}",
                            file.gamma ? fmt::format("gamma {}", *file.gamma) : "sRGB's tone curve",
                            *scene.camera_model.gamma),
                {path.string()});
  return file;
}

disk_cache::Cache cache_of(const Options& options, const char* kind) {
  const fs::path folder = cache_folder(options, kind);
  return folder.empty() ? disk_cache::Cache() : disk_cache::Cache(folder);
}

// Measures the whole clip, so that all scenes over one clip have the same camera.
camera_file::Calibration measured_on(const scene::Scene& scene,
                                     const lens::ImageSize& size,
                                     const image::Mask* mask,
                                     setup::SharedInputs& inputs,
                                     const Options& options) {
  camera_file::Options how;
  how.lens = setup::lens_of(scene.lens, size);
  how.own_aircraft = mask;
  if (!scene.camera.path_file && !scene.camera.log && scene.camera.position_ned_m.z() < 0)
    how.altitude_m = -scene.camera.position_ned_m.z();
  how.picture_rate_hz = scene.background.frame_rate_hz;
  how.tone = setup::tone_of(scene.camera_model);
  how.stop = options.stop;
  how.warn = options.warn;
  how.progress = [&](std::int64_t done, std::int64_t total) {
    if (options.progress) options.progress({done, total, "measuring the camera"});
  };
  const camera_file::CacheKey key{
      setup::sha256_of_video(scene.background.video, inputs),
      scene.background.mask ? sha256_of_file(*scene.background.mask) : "",
      setup::words_of(*how.lens),
      how.altitude_m,
      how.tone,
      how.picture_rate_hz};
  return camera_file::calibrate_once(
      scene.background.video, how, cache_of(options, "calibration"), key);
}

// From north, where the calibration has it from the heading of the camera in the clip's first
// frame. Empty where the scene begins after a cut, beyond which no heading is known.
std::optional<double> sun_azimuth_deg(const scene::Scene& scene,
                                      const camera_file::Calibration& found) {
  const auto first = static_cast<std::size_t>(scene.background.first_frame);
  if (first > 0 && first >= found.yaw_from_first_deg.size()) return std::nullopt;
  const double turned_deg = first > 0 ? found.yaw_from_first_deg[first] : 0;
  const auto camera = setup::camera_path(scene.camera).at(0);
  const double heading_deg = camera ? yaw_pitch_roll(camera->world_from_body).yaw_deg : 0;
  const double azimuth_deg =
      std::remainder(found.quantities.sun_azimuth.value().value + heading_deg - turned_deg, 360);
  return azimuth_deg < 0 ? azimuth_deg + 360 : azimuth_deg;
}

// Many clips show no edges of colour, and a decoder may not report its quantiser. Where [realism]
// auto asks for these, such a clip is measured in all other quantities.
bool may_be_missing(std::string_view name, const scene::Realism& realism) {
  const scene::IfUnmeasured rule = scene::camera_key(name)->if_unmeasured;
  return rule == scene::IfUnmeasured::kLeftOut ||
         (rule == scene::IfUnmeasured::kLeftOutWithAuto && realism.automatic);
}

bool is_wanted(const scene::Scene& scene, const std::string& key) {
  return scene.realism.automatic || std::ranges::count(scene.camera_model.automatic, key) > 0;
}

// Fills in unstated values from the camera file.
void fill_from_file(scene::Scene& scene, const scene::CameraFile& file) {
  scene::CameraModel& model = scene.camera_model;
  scene::for_each_camera_key(
      [](const char* /*key*/, auto& stated, const auto& filed) {
        if (!stated) stated = filed;
      },
      model,
      file.model);
  if (!model.readout) model.readout = file.model.readout;
  if (!model.gamma) model.gamma = file.gamma;
}

// The chroma-key method cannot model a camera and its air; modelling a part of them would be worse
// than none.
void refuse_with_chroma_key(const scene::Scene& scene) {
  if (scene.composite.method != scene::CompositeMethod::kChromaKey) return;
  if (scene.realism.file || scene.realism.automatic || scene::states_any_key(scene.camera_model) ||
      scene::states_any_key(scene.weather))
    throw Error(
        "composite.method chroma-key is for the picture as it is, without [shutter], [air], "
        "[optics], [sensor], [weather] and [realism]; expected none of them, or method = "
        "\"matte\"",
        scene.realism.where.line > 0 ? scene.realism.where : Where{scene.file.string()});
}

void take_angle(scene::Scene& scene, const video::StreamInfo& info) {
  scene::CameraModel& model = scene.camera_model;
  if (!model.angle_deg) return;
  const double rate_hz = info.frame_rate.value();
  if (!(rate_hz > 0))
    throw Error("has no frame rate, which shutter.angle_deg is a share of; expected exposure_s",
                {scene.background.video.string()});
  model.exposure_s = *model.angle_deg / 360 / rate_hz;
  model.angle_deg.reset();
}

// A named profile is applied to measured values, so at least one value must be measured.
void check_profile(const scene::Realism& realism,
                   const video::StreamInfo& info,
                   bool is_any_to_measure) {
  if (!realism.profile) return;
  camera_file::check_size(camera_file::camera_profile(*realism.profile, realism.where),
                          info.width,
                          info.height,
                          realism.where);
  if (!is_any_to_measure)
    throw Error(
        "profile is for what is measured from the clip, and nothing is; expected auto = "
        "true, or a key that is \"auto\"",
        realism.where);
}

// Takes the requested values from the clip, as far as it can be measured, and from the camera's
// profile.
void take_measured(scene::Scene& scene,
                   const StatedScene& stated,
                   camera_file::Calibration measured,
                   const Warn& to_warn) {
  const camera_file::Quantities of_clip = measured.quantities;
  const scene::Realism& realism = stated.realism;
  // Where no profile is named, by the median of cameras.
  const camera_file::Calibration found = camera_file::with_profile(
      std::move(measured),
      realism.profile ? camera_file::camera_profile(*realism.profile, realism.where)
                      : camera_file::usual_camera());
  const scene::CameraModel from_clip = camera_file::model_of(found);
  scene::for_each_camera_key(
      [&](const char* key, auto& value, const auto& seen) {
        if (std::ranges::count(stated.to_measure, key) == 0) return;
        value = seen;
        if (key == std::string_view("air.extinction_per_km") && !of_clip.extinction.note.empty())
          warn(to_warn, fmt::format("{} is {}", key, of_clip.extinction.note));
        if (value && (realism.profile || of_clip.at(key).missing.empty())) return;
        std::string what = fmt::format("{} cannot be measured: {}", key, of_clip.at(key).missing);
        if (key == std::string_view("air.airlight") && !found.no_horizon.empty())
          what += " (" + found.no_horizon + ")";
        if (!realism.fallback && !may_be_missing(key, realism))
          throw Error(
              what + (value ? "; state it, name the camera's profile in [realism], or set fallback "
                              "= true to take what cameras have in the median"
                            : "; state it, or set fallback = true in [realism] to leave it out"),
              realism.where.line > 0 ? realism.where : Where{scene.file.string()});
        // The profile's words for a camera file say again that the clip does not show it.
        const std::string& source = found.quantities.at(key).source;
        warn(to_warn,
             what + (value ? "; it is " + source.substr(0, source.find(';')) : "; it is left out"));
      },
      scene.camera_model,
      from_clip);
  if (realism.profile)
    for (const std::string& key : stated.to_measure)
      if (const std::string& doubt = found.quantities.at(key).doubt; !doubt.empty())
        warn(to_warn, key + " is doubtful: " + doubt);
  if (!scene.camera_model.readout) scene.camera_model.readout = from_clip.readout;
  if (stated.sun_is_known || !found.quantities.sun_azimuth.is_measured()) return;
  const auto azimuth_deg = sun_azimuth_deg(scene, found);
  if (!azimuth_deg)
    return warn(to_warn,
                "the sun is measured before a cut, and the scene begins after it: its direction is "
                "not known there; [light] sun_azimuth_deg and sun_elevation_deg state it");
  scene.light.sun_azimuth_deg = *azimuth_deg;
  scene.light.sun_elevation_deg = found.quantities.sun_elevation.value().value;
}

// The requested keys that neither the scene nor its camera file states.
std::vector<std::string> left_to_measure(const scene::Scene& filled) {
  std::vector<std::string> keys;
  scene::for_each_camera_key(
      [&](const char* key, const auto& value) {
        if (!value && is_wanted(filled, key)) keys.emplace_back(key);
      },
      filled.camera_model);
  return keys;
}

// The stream with the number of frames that the scene makes of it.
video::StreamInfo used_stream(video::StreamInfo info, const scene::Background& background) {
  const std::int64_t left =
      std::max<std::int64_t>(0, info.frame_count_estimate - background.first_frame);
  info.frame_count_estimate = left;
  if (background.frame_count)
    info.frame_count_estimate =
        left > 0 ? std::min(left, *background.frame_count) : *background.frame_count;
  info.is_frame_count_stated = info.is_frame_count_stated || background.frame_count;
  return info;
}

// The frame of a known motion that a moment of [[intruder.seen]] is about.
setup::FramePose frame_near(const setup::MotionSource& motion,
                            const video::StreamInfo& info,
                            const scene::Seen& seen) {
  const setup::MotionSource::Measured frame = motion.nearest(seen.time_s);
  const double rate_hz = info.frame_rate.value();
  const double interval_s = rate_hz > 0 ? 1 / rate_hz : 1;
  if (std::abs(frame.motion.time_s - seen.time_s) > interval_s && !info.variable_frame_rate)
    throw Error(fmt::format("time_s is {:.3f}, where the clip has no frame: the nearest is at "
                            "{:.3f} s; expected a time within the clip",
                            seen.time_s,
                            frame.motion.time_s),
                seen.where);
  return {frame.motion.time_s, frame.shake};
}

bool is_given_by_what_is_seen(const scene::Scene& scene) {
  return std::ranges::any_of(scene.intruders,
                             [](const auto& intruder) { return !intruder.seen.empty(); });
}

// For a second reading: what is to be said of the video, the first says.
video::Reader reopened_background(const scene::Scene& scene, Options options) {
  options.warn = {};
  return open_background(scene, options);
}

lens::ImageSize size_of(const video::StreamInfo& info) { return {info.width, info.height}; }

// The scene as a preview draws it (Options::is_preview).
void simplify_for_preview(scene::Scene& scene) {
  scene.motion.model = setup::motion_model(scene);
  scene.composite.method = scene::CompositeMethod::kMatte;
  scene.camera_model.codec_step.reset();
}

// Codes of a curve for high dynamic range are no light that a camera of standard range records.
void expect_standard_range(const scene::Scene& scene, const video::StreamInfo& info) {
  constexpr int kPq = 16;   // AVCOL_TRC_SMPTE2084
  constexpr int kHlg = 18;  // AVCOL_TRC_ARIB_STD_B67
  if (info.transfer_tag != kPq && info.transfer_tag != kHlg) return;
  throw Error(
      fmt::format("is of high dynamic range ({}); expected standard range, as `ffmpeg -i IN -vf "
                  "zscale=t=linear:npl=100,tonemap=hable,zscale=p=bt709:t=bt709:m=bt709:r=tv,"
                  "format=yuv420p OUT` makes it",
                  info.transfer_tag == kPq ? "PQ" : "HLG"),
      {scene.background.video.string()});
}

// Throws Error at the table that names it for a file that is not there. The readers of numbered
// pictures check their patterns.
void expect_there(const scene::StatedFile& file) {
  std::error_code ignored;
  if (file.path.string().find('%') == std::string::npos && !fs::exists(file.path, ignored))
    throw Error(file.path.string() + " does not exist; expected a file", file.where);
}

// A factor of [weather] has something to multiply, be it measured later.
void check_weather(const scene::Scene& scene, const std::vector<std::string>& to_measure) {
  const auto is_known = [&](const std::optional<double>& value, const char* key) {
    return value || std::ranges::count(to_measure, key) > 0;
  };
  const auto refuse = [&](const char* name, const char* key) {
    throw Error(fmt::format("[weather] {} is a factor on {}, which the scene has not; expected a "
                            "number or \"auto\" there, or [realism]",
                            name,
                            key),
                scene.weather.where);
  };
  const scene::CameraModel& model = scene.camera_model;
  if (scene.weather.blur && !is_known(model.point_spread_px, "optics.point_spread_px"))
    refuse("blur", "optics.point_spread_px");
  if (scene.weather.noise && !is_known(model.noise_gain, "sensor.noise_gain") &&
      !is_known(model.noise_floor, "sensor.noise_floor"))
    refuse("noise", "sensor.noise_gain");
}

}  // namespace

StatedScene stated(const scene::Scene& scene, const video::StreamInfo& info) {
  // The frames may come from elsewhere than the video.
  const std::vector<scene::StatedFile> files = scene::stated_files(scene);
  std::for_each(files.begin() + 1, files.end(), expect_there);
  StatedScene result{scene, scene.realism, {}, scene.light.sun_is_stated};
  refuse_with_chroma_key(scene);
  expect_standard_range(scene, info);
  setup::take_pixel_shape(result.scene.lens, size_of(info), info.sample_aspect.value());
  take_angle(result.scene, info);
  setup::state_clip_start(result.scene.camera,
                          scene.background.video,
                          scene.background.first_frame,
                          scene.background.frame_rate_hz);
  scene::CameraFile file;
  if (scene.realism.file) file = file_of(result.scene, size_of(info));
  fill_from_file(result.scene, file);
  result.to_measure = left_to_measure(result.scene);
  check_profile(scene.realism, info, !result.to_measure.empty());
  if (!result.realism.profile && !result.to_measure.empty())
    if (const auto* known = camera_file::recognised_profile(info.width, info.height, info.tags))
      result.realism.profile = known->name;
  check_weather(result.scene, result.to_measure);
  if (!result.sun_is_known && file.sun_azimuth_deg && file.sun_elevation_deg) {
    result.scene.light.sun_azimuth_deg = *file.sun_azimuth_deg;
    result.scene.light.sun_elevation_deg = *file.sun_elevation_deg;
    result.sun_is_known = true;
  }
  result.scene.camera_model.automatic.clear();
  result.scene.realism = {};
  return result;
}

scene::Scene with_measured_camera(StatedScene stated,
                                  const lens::ImageSize& size,
                                  const image::Mask* mask,
                                  setup::SharedInputs& inputs,
                                  const Options& options) {
  if (!stated.to_measure.empty()) {
    camera_file::Calibration measured = measured_on(stated.scene, size, mask, inputs, options);
    take_measured(stated.scene, stated, std::move(measured), options.warn);
  }
  return std::move(stated.scene);
}

void check_rate(const scene::Background& background, const video::StreamInfo& info) {
  if (!info.is_rate_stated)
    throw Error(
        "the background is of numbered pictures, which state no rate; expected "
        "frame_rate_hz, their frames a second, in [background]",
        background.where);
  if (background.frame_rate_hz && !info.is_of_pictures)
    throw Error(fmt::format("frame_rate_hz is {}, and the background is a video, which has its own "
                            "rate; expected frame_rate_hz for numbered pictures alone",
                            *background.frame_rate_hz),
                background.where);
}

video::Reader open_background(const scene::Scene& scene, const Options& options) {
  expect_there({scene.background.video, scene.background.where});
  video::Reader reader(scene.background.video,
                       {.first_frame = scene.background.first_frame,
                        .frame_count = scene.background.frame_count,
                        .picture_rate_hz = scene.background.frame_rate_hz,
                        .threads = options.threads,
                        .with_cuts = true,
                        .where = scene.background.where},
                       options.warn);
  check_rate(scene.background, reader.info());
  return reader;
}

OpenedScene open_scene(const scene::Scene& scene, const Options& options) {
  video::Reader background = open_background(scene, options);
  OpenedScene opened = open_over(background.info(), scene, options);
  opened.background.emplace(std::move(background));
  return opened;
}

OpenedScene open_over(const video::StreamInfo& of_video,
                      const scene::Scene& scene,
                      const Options& options) {
  StatedScene as_stated = stated(scene, of_video);
  scene::Scene& opened = as_stated.scene;
  if (options.is_preview) simplify_for_preview(opened);
  const lens::ImageSize size = size_of(of_video);
  auto inputs = inputs_of(options);
  std::shared_ptr<const image::Mask> mask;
  if (opened.background.mask) mask = inputs->mask_of(*opened.background.mask, size);
  std::vector<std::string> notes;
  setup::warn_of_hover(opened.camera, options.warn);
  const std::string attitude_words = setup::state_attitude(
      opened.camera,
      setup::lens_of(opened.lens, size),
      mask.get(),
      [&] { return reopened_background(scene, options); },
      options.stop);
  if (!attitude_words.empty()) notes.push_back(attitude_words);
  if (as_stated.realism.profile != scene.realism.profile)
    notes.push_back(
        fmt::format("camera: the video's tags are those of {}, whose profile is used; "
                    "[realism] profile = \"none\" leaves it out",
                    *as_stated.realism.profile));
  setup::World world = setup::load_world(opened, size, options.warn, options.stop, inputs.get());
  auto backdrop = insertion::open_backdrop(
      opened, world.lens, {.gpu = options.gpu, .software = options.software_gl});
  opened.motion.model = setup::motion_model(opened);
  // sequence.json records the scale that is drawn, so that the same scene gives the same sizes
  // whatever the table of published sizes becomes.
  for (std::size_t i = 0; i < world.actors.size(); ++i)
    if (const double scale = world.actors[i].type->aircraft->catalogue_scale; scale != 1)
      opened.intruders[i].catalogue_scale = scale;
  const video::StreamInfo info = used_stream(of_video, scene.background);
  setup::check_camera_path(world, info, options.warn);
  world.camera = setup::steady_camera(world.camera, opened, info);
  if (const double rate_hz = info.frame_rate.value(); rate_hz > 0)
    setup::warn_of_gaps(
        opened.camera, static_cast<double>(info.frame_count_estimate) / rate_hz, options.warn);
  // A container may state a frame or two more than it holds; nothing bounds an estimate.
  const std::int64_t at_least = scene.background.frame_count.value_or(
      info.is_frame_count_stated ? std::max<std::int64_t>(0, info.frame_count_estimate - 2) : 0);
  insertion::Occluders occluders(opened, world.lens, mask.get(), at_least, options.warn);
  return {{std::nullopt,
           info,
           std::move(mask),
           std::move(occluders),
           std::move(inputs),
           std::move(world),
           std::move(backdrop),
           std::move(notes)},
          std::move(as_stated)};
}

setup::MotionInputs motion_inputs(const OpenedScene& opened,
                                  const std::string& video_sha256,
                                  const Options& options) {
  return {opened.stated.scene,
          opened.world.lens,
          !opened.world.shutter.is_instant(),
          video_sha256,
          opened.mask.get(),
          cache_of(options, "motion")};
}

void place_seen(OpenedScene& opened,
                const setup::MotionSource& motion,
                const std::stop_token& stop) {
  setup::place_seen(
      opened.stated.scene,
      opened.world,
      [&](const scene::Seen& seen) { return frame_near(motion, opened.info, seen); },
      stop,
      opened.inputs.get());
}

void measure_camera(OpenedScene& opened, const Options& options) {
  scene::Scene& scene = opened.stated.scene;
  scene = with_measured_camera(
      std::move(opened.stated), size_of(opened.info), opened.mask.get(), *opened.inputs, options);
  insertion::check_codec(scene, opened.info.colour);
  opened.world.shutter = setup::shutter_of(scene.camera_model);
  opened.world.to_sun_in_world = setup::to_sun_in_world(scene.light);
}

ResolvedScene resolve(OpenedScene opened, const Options& options) {
  measure_camera(opened, options);
  const scene::Scene& scene = opened.stated.scene;
  const std::string video_sha256 = setup::sha256_of_video(scene.background.video, *opened.inputs);
  const bool has_seen = is_given_by_what_is_seen(scene);
  setup::MotionSource motion(motion_inputs(opened, video_sha256, options),
                             {.for_all = has_seen,
                              .open = [&] { return reopened_background(scene, options); },
                              .stop = options.stop,
                              .seen = {}});
  if (has_seen) place_seen(opened, motion, options.stop);
  ResolvedScene resolved = resolved_by_truth(std::move(opened));
  resolved.video_sha256 = video_sha256;
  resolved.motion.emplace(std::move(motion));
  return resolved;
}

ResolvedScene resolved_by_truth(OpenedScene opened) {
  return {std::move(static_cast<SceneInputs&>(opened)), std::move(opened.stated.scene), "", {}};
}

setup::MotionSource motion_ahead(const scene::Scene& scene, const Options& options) {
  video::Reader reader = open_background(scene, options);
  const video::StreamInfo info = used_stream(reader.info(), scene.background);
  const scene::Scene plain = stated(scene, reader.info()).scene;
  const auto mask = insertion::read_mask(plain, size_of(info));
  const lens::Lens lens = setup::lens_of(plain.lens, size_of(info));
  const setup::MotionInputs inputs{
      plain,
      lens,
      !setup::shutter_of(plain.camera_model).is_instant(),
      setup::sha256_of_video(scene.background.video, *inputs_of(options)),
      mask ? &*mask : nullptr,
      cache_of(options, "motion")};
  return {inputs,
          {.for_all = true,
           .open = [&] { return std::move(reader); },
           .stop = options.stop,
           .seen =
               [&](std::int64_t done) {
                 if (options.progress) options.progress({done, info.frame_count_estimate});
               }}};
}

void measure_ahead(const scene::Scene& scene, const Options& options) {
  if (scene.motion.model != scene::MotionModel::kNone) motion_ahead(scene, options);
}

fs::path cache_folder(const Options& options, const char* kind) {
  if (!options.use_cache) return {};
  return options.cache.empty() ? disk_cache::user_folder(kind) : options.cache / kind;
}

bool needs_calibration(const scene::Scene& scene) {
  if (scene.composite.method == scene::CompositeMethod::kChromaKey) return false;
  scene::Scene filled = scene;
  // A shutter angle is an exposure, once the frame rate is known.
  if (filled.camera_model.angle_deg) filled.camera_model.exposure_s = 0;
  if (scene.realism.file) fill_from_file(filled, scene::read_camera_file(*scene.realism.file));
  return !left_to_measure(filled).empty();
}

camera_file::Calibration calibration_of(const scene::Scene& scene, const Options& options) {
  scene::Scene filled = scene;
  const video::StreamInfo info = video::Reader(scene.background.video, {}, options.warn).info();
  const lens::ImageSize size = size_of(info);
  setup::take_pixel_shape(filled.lens, size, info.sample_aspect.value());
  if (scene.realism.file) fill_from_file(filled, file_of(filled, size));
  const auto mask = insertion::read_mask(scene, size);
  return measured_on(filled, size, mask ? &*mask : nullptr, *inputs_of(options), options);
}

void check_scene(const scene::Scene& scene, const video::StreamInfo& info) {
  const lens::ImageSize size{info.width, info.height};
  check_rate(scene.background, info);
  const StatedScene with_camera = stated(scene, info);
  const auto mask = insertion::read_mask(scene, size);
  const lens::Lens lens = setup::lens_of(scene.lens, size);
  insertion::Occluders(
      scene, lens, mask ? &*mask : nullptr, scene.background.frame_count.value_or(0));
  setup::motion_model(scene);
  insertion::check_method(scene, lens);
  setup::check_paths(with_camera.scene, info);
}

std::shared_ptr<setup::SharedInputs> inputs_of(const Options& options) {
  return options.shared
             ? options.shared
             : std::make_shared<setup::SharedInputs>(cache_folder(options, "ambient_occlusion"));
}

}  // namespace airtruth::pipeline
