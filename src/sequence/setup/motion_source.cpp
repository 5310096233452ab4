// SPDX-License-Identifier: Apache-2.0
#include "sequence/setup/motion_source.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "camera/lens/calibration_file.h"
#include "camera/motion/shake.h"
#include "foundation/base/error.h"
#include "picture/video/metadata.h"
#include "picture/video/numbered_images.h"
#include "picture/video/still.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::setup {
namespace {

// The most frames for which memory is set aside on the word of a container.
constexpr std::int64_t kMostReserved = 1'000'000;

// The motion of the frame that all others are measured against, and of each in a clip that does not
// shake.
motion::FrameMotion reference_at(const video::Frame& frame, bool is_rotation = false) {
  motion::FrameMotion reference;
  reference.frame = frame.index;
  reference.time_s = frame.time_s;
  if (is_rotation) reference.rotation = Quaternion::Identity();
  return reference;
}

// Samples of a video's own gyroscope (a GoPro's telemetry); empty where the video has none.
std::vector<gyro::GyroSample> gyro_of(const fs::path& video) {
  std::vector<gyro::GyroSample> gyro;
  for (const video::TelemetryPacket& packet : video::read_telemetry(video))
    for (const gyro::GyroSample& sample :
         gyro::gyro_from_gpmf(packet.bytes, packet.begin_s, packet.end_s))
      gyro.push_back(sample);
  return gyro;
}

// Replaces rotations that could not be measured by the gyroscope's, where the gyroscope agrees with
// the measured ones. Returns how well it fits. Returns empty and changes nothing where it does not
// agree.
std::optional<gyro::GyroFit> bridge_by_gyro(const std::vector<gyro::GyroSample>& gyro,
                                            std::vector<motion::FrameMotion>& motion) {
  if (gyro.empty() || motion.empty() || !motion.front().rotation) return std::nullopt;
  const auto fit = gyro::fit_gyro(gyro, motion);
  if (fit) motion = gyro::bridged_by_gyro(motion, gyro, *fit);
  return fit;
}

// The lens for a rotation; empty for a homography. As in scenes a rotation is the default, but
// where no lens is stated none can be measured.
std::optional<lens::Lens> lens_of_options(const ClipMotionOptions& options,
                                          const lens::ImageSize& size) {
  if (options.model == scene::MotionModel::kNone)
    throw Error("the model is none; expected auto, rotation or homography");
  if (options.model == scene::MotionModel::kHomography && !options.lens.empty())
    throw Error("a lens is for the model rotation; a homography knows none");
  if (options.model == scene::MotionModel::kRotation && options.lens.empty())
    throw Error("the model rotation needs a lens, a calibration file");
  if (options.lens.empty()) return std::nullopt;
  return lens::read_calibration(options.lens, size, options.warn);
}

void warn_of(const ClipMotion& found, bool has_gyro, const Warn& warn) {
  if (!warn) return;
  if (has_gyro && !found.gyro)
    warn("the video's gyro does not agree with its motion; it is not used");
  const auto away =
      std::ranges::count(found.frames, motion::State::kTurnedAway, &motion::FrameMotion::state);
  if (away > 0)
    warn(fmt::format(
        "in {} frames the camera has turned or flown so far from the first that no homography "
        "holds both (turned_away); the reference smoothed and the model rotation have "
        "no such limit",
        away));
}

}  // namespace

std::string words_of(const lens::Lens& lens) {
  const lens::Facts facts = lens::facts_of(lens);
  return fmt::format("{} {} {} {}",
                     facts.model,
                     fmt::join(facts.focal_px, ","),
                     fmt::join(facts.principal_point_px, ","),
                     fmt::join(facts.distortion, ",")) +
         (facts.max_angle_rad < kPi ? fmt::format(" {}", facts.max_angle_rad) : "");
}

std::string sha256_of_video(const fs::path& video, SharedInputs& inputs) {
  const auto images = video::numbered_images(video);
  if (!images) return fs::is_regular_file(video) ? inputs.sha256_of_file(video) : "";
  std::string all;
  for (const fs::path& file : images->files)
    all += file.filename().string() + ' ' + inputs.sha256_of_file(file) + '\n';
  return sha256_of(all);
}

std::vector<fs::path> files_read(const scene::Scene& scene) {
  std::vector<fs::path> files;
  for (const scene::StatedFile& file : scene::stated_files(scene)) files.push_back(file.path);
  const auto add_series = [&](const fs::path& path) {
    if (const auto images = video::numbered_images(path))
      files.insert(files.end(), images->files.begin(), images->files.end());
  };
  add_series(scene.background.video);
  for (const scene::Occluder& occluder : scene.occluders)
    if (occluder.mask) add_series(*occluder.mask);
  return files;
}

scene::MotionModel motion_model(const scene::Scene& scene) {
  const bool paper = scene.composite.method == scene::CompositeMethod::kChromaKey;
  if (scene.motion.model == scene::MotionModel::kRotation && paper)
    throw Error(
        "motion.model rotation is not for composite.method chroma-key, which warps planes; "
        "expected model = \"homography\" or method = \"matte\"",
        scene.motion.where);
  if (scene.motion.model != scene::MotionModel::kAuto) return scene.motion.model;
  return paper ? scene::MotionModel::kHomography : scene::MotionModel::kRotation;
}

MotionSource::MotionSource(const MotionInputs& inputs)
    : mask_(inputs.mask), size_(inputs.lens.size()), guard_(size_.width, size_.height) {
  const scene::Scene& scene = inputs.scene;
  const scene::MotionModel model = motion_model(scene);
  none_ = model == scene::MotionModel::kNone;
  smoothed_ = !none_ && scene.motion.reference == scene::MotionReference::kSmoothed;
  needs_change_ = inputs.needs_change;
  if (model == scene::MotionModel::kRotation) lens_ = inputs.lens;
  // The gyroscope's clock starts with the file.
  if (lens_ && scene.background.first_frame == 0) gyro_ = gyro_of(scene.background.video);
  if (!inputs.video_sha256.empty() && !none_) cache_ = inputs.cache;
  options_.seed = scene.seed;
  options_.smoothing_s = scene.motion.smoothing_s;
  key_.video_sha256 = inputs.video_sha256;
  if (scene.background.mask) key_.mask_sha256 = sha256_of_file(*scene.background.mask);
  key_.first_frame = scene.background.first_frame;
  key_.frame_count = scene.background.frame_count.value_or(-1);
  if (lens_) key_.lens = words_of(*lens_);
  key_.options = options_;
  key_.picture_rate_hz = scene.background.frame_rate_hz;
  if (!cache_.keeps()) return;
  if (auto found = motion::cached(cache_, key_)) set_pass(std::move(*found));
}

MotionSource::MotionSource(const MotionInputs& inputs, const MotionPass& pass)
    : MotionSource(inputs) {
  if (needs_pass(pass.for_all)) measure(pass);
}

std::optional<MotionSource> MotionSource::from_cache(const MotionInputs& inputs) {
  MotionSource source(inputs);
  if (!source.ready_) return std::nullopt;
  return source;
}

MotionSource MotionSource::of_frames(MotionInputs inputs, std::span<const video::Frame> frames) {
  inputs.cache = {};
  MotionSource source(inputs);
  std::vector<motion::FrameMotion> measured;
  for (const video::Frame& frame : frames)
    measured.push_back(frames.size() == 1 ? reference_at(frame, source.lens_.has_value())
                                          : source.measured(frame));
  source.set_pass(std::move(measured));
  return source;
}

motion::Estimator MotionSource::estimator() const {
  return lens_ ? motion::Estimator(*lens_, options_, mask_)
               : motion::Estimator(size_.width, size_.height, mask_);
}

void MotionSource::set_pass(std::vector<motion::FrameMotion> against_first) {
  gyro_fit_ = bridge_by_gyro(gyro_, against_first);
  all_ = smoothed_ ? motion::smoothed(std::move(against_first), options_)
                   : motion::within_reach(std::move(against_first), size_.width, size_.height);
  ready_ = true;
}

void MotionSource::measure(const MotionPass& pass) {
  if (!none_) {
    auto against_first = measure_motion(pass.open(), estimator(), pass.stop, pass.seen);
    if (cache_.keeps()) motion::store(cache_, key_, against_first);
    return set_pass(std::move(against_first));
  }
  video::Reader reader = pass.open();
  while (const auto frame = reader.next()) {
    if (pass.stop.stop_requested()) throw Interrupted();
    all_.push_back(reference_at(*frame));
    if (pass.seen) pass.seen(std::ssize(all_));
  }
  ready_ = true;
}

MotionSource::Measured MotionSource::next(const video::Frame& frame) {
  if (!ready_) {
    const motion::FrameMotion motion = guard_.next(measured(frame));
    return {motion, motion::shake_of({motion}, 0)};
  }
  check(frame.index < static_cast<std::int64_t>(all_.size()), "motion is known for every frame");
  return at(static_cast<std::size_t>(frame.index));
}

MotionSource::Measured MotionSource::at(std::size_t k) const {
  return {all_[k], needs_change_ ? motion::shake_of(all_, k) : motion::shake_of({all_[k]}, 0)};
}

MotionSource::Measured MotionSource::nearest(double time_s) const {
  check(ready_ && !all_.empty(), "the clip's motion is known");
  const auto after = std::ranges::lower_bound(all_, time_s, {}, &motion::FrameMotion::time_s);
  auto k = static_cast<std::size_t>(after - all_.begin());
  if (k == all_.size() || (k > 0 && time_s - all_[k - 1].time_s <= all_[k].time_s - time_s)) --k;
  return at(k);
}

motion::FrameMotion MotionSource::measured(const video::Frame& frame) {
  if (none_) return reference_at(frame);
  if (!estimator_) estimator_.emplace(estimator());
  motion::FrameMotion motion =
      estimator_->next(frame.picture, frame.time_s, frame.damaged, frame.begins_shot);
  motion.frame = frame.index;
  if (cache_.keeps()) motion::pack(motion, against_first_);
  return motion;
}

void MotionSource::store() {
  if (!against_first_.empty()) motion::store(cache_, key_, std::move(against_first_));
}

std::vector<motion::FrameMotion> measure_motion(video::Reader reader,
                                                motion::Estimator estimator,
                                                const std::stop_token& stop,
                                                const std::function<void(std::int64_t)>& seen) {
  std::vector<motion::FrameMotion> result;
  // A vector that grows holds its frames twice.
  result.reserve(static_cast<std::size_t>(
      std::clamp<std::int64_t>(reader.info().frame_count_estimate, 0, kMostReserved)));
  while (const auto frame = reader.next()) {
    if (stop.stop_requested()) throw Interrupted();
    result.push_back(
        estimator.next(frame->picture, frame->time_s, frame->damaged, frame->begins_shot));
    result.back().frame = frame->index;
    if (seen) seen(static_cast<std::int64_t>(result.size()));
  }
  return result;
}

ClipMotion clip_motion(const fs::path& video, const ClipMotionOptions& options) {
  if (!(options.smoothing_s > 0) || !std::isfinite(options.smoothing_s))
    throw Error(
        fmt::format("the smoothing is {} s; expected a number above 0", options.smoothing_s));
  video::Reader reader(
      video, {.picture_rate_hz = options.picture_rate_hz, .with_cuts = true}, options.warn);
  ClipMotion result;
  result.info = reader.info();
  video::expect_rate(video, result.info, options.picture_rate_hz);
  const lens::ImageSize size{result.info.width, result.info.height};
  result.lens = lens_of_options(options, size);
  std::optional<image::Mask> mask;
  scene::Scene scene;
  scene.background.video = video;
  scene.background.frame_rate_hz = options.picture_rate_hz;
  if (!options.mask.empty()) {
    scene.background.mask = options.mask;
    mask = video::read_mask(options.mask, size.width, size.height);
  }
  scene.motion.model =
      result.lens ? scene::MotionModel::kRotation : scene::MotionModel::kHomography;
  scene.motion.reference = options.reference;
  scene.motion.smoothing_s = options.smoothing_s;
  // A homography knows no lens, but for the size of its pictures.
  const lens::Lens lens = result.lens.value_or(lens::pinhole_from_vertical_fov(60, size));
  SharedInputs inputs;
  MotionSource source({.scene = scene,
                       .lens = lens,
                       .video_sha256 = options.cache.keeps() ? sha256_of_video(video, inputs) : "",
                       .mask = mask ? &*mask : nullptr,
                       .cache = options.cache},
                      {.for_all = true,
                       .open = [&] { return std::move(reader); },
                       .stop = options.stop,
                       .seen =
                           [&](std::int64_t done) {
                             if (options.progress)
                               options.progress(done, result.info.frame_count_estimate);
                           }});
  const bool has_gyro = source.has_gyro();
  result.gyro = source.gyro_fit();
  result.frames = std::move(source).all();
  warn_of(result, has_gyro, options.warn);
  return result;
}

}  // namespace airtruth::setup
