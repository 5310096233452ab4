// SPDX-License-Identifier: Apache-2.0
#include "sequence/sequence/frame_maker.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "sequence/frame/frame_truth.h"
#include "sequence/setup/from_scene.h"

namespace airtruth::sequence {
namespace {

lens::ImageSize size_of(const video::StreamInfo& info) { return {info.width, info.height}; }

bool is_given_by_what_is_seen(const scene::Scene& scene) {
  return std::any_of(scene.intruders.begin(), scene.intruders.end(), [](const auto& intruder) {
    return !intruder.seen.empty();
  });
}

}  // namespace

FramePose frame_near(const MotionSource& motion,
                     const video::StreamInfo& info,
                     const scene::Seen& seen) {
  const MotionSource::Measured frame = motion.nearest(seen.time_s);
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

video::StreamInfo used_stream(video::StreamInfo info, const scene::Background& background) {
  const std::int64_t left =
      std::max<std::int64_t>(0, info.frame_count_estimate - background.first_frame);
  info.frame_count_estimate = left;
  if (background.frame_count)
    info.frame_count_estimate =
        left > 0 ? std::min(left, *background.frame_count) : *background.frame_count;
  return info;
}

fs::path openness_cache(const Options& options) {
  if (!options.use_cache) return {};
  return (options.cache.empty() ? disk_cache::user_folder() : options.cache) / "openness";
}

video::Reader open_background(const scene::Scene& scene, const Options& options) {
  video::ReaderOptions reader_options;
  reader_options.first_frame = scene.background.first_frame;
  reader_options.frame_count = scene.background.frame_count;
  reader_options.threads = options.threads;
  reader_options.with_cuts = true;
  reader_options.avoids_copies = true;
  return video::Reader(scene.background.video, reader_options, options.warn);
}

// ---------------------------------------------------------------- before the first frame

Setting::Setting(const StatedScene& stated,
                 const lens::ImageSize& image_size,
                 const Options& options)
    : scene(stated.scene),
      size(image_size),
      mask(read_mask(scene, size)),
      inputs(options.shared ? options.shared
                            : std::make_shared<SharedInputs>(openness_cache(options))),
      world(load_world(scene, size, options.warn, options.stop, inputs.get())),
      painter(make_painter(
          scene, world, own_aircraft(), {options.gpu, options.software_gl, options.stop})) {
  scene.motion.model = motion_model(scene);
  // sequence.json records the scale that is drawn, so that the same scene gives the same sizes
  // whatever the table of published sizes becomes.
  for (std::size_t i = 0; i < world.actors.size(); ++i)
    if (const double scale = world.actors[i].type->catalogue_scale; scale != 1)
      scene.intruders[i].catalogue_scale = scale;
}

FrameMaker::FrameMaker(const scene::Scene& scene, const Options& options)
    : options_(options),
      reader_(open_background(scene, options)),
      stated_(stated(scene, reader_.info())),
      setting_(stated_, size_of(reader_.info()), options),
      info_(used_stream(reader_.info(), scene.background)) {
  check_camera_path(setting_.world.camera, info_);
}

void FrameMaker::measure() {
  stated_.scene = setting_.scene;
  setting_.scene = resolved(stated_, setting_.size, setting_.own_aircraft(), options_);
  check_codec(setting_.scene, reader_.info().colour);
  setting_.world.shutter = shutter_of(setting_.scene.camera_model);
  setting_.world.to_sun_in_world = to_sun_in_world(setting_.scene.light);

  video_sha256_ = sha256_of_video(setting_.scene.background.video, setting_.inputs.get());
  motion_.emplace(setting_.scene,
                  setting_.world.lens,
                  !setting_.world.shutter.is_instant(),
                  video_sha256_,
                  setting_.own_aircraft(),
                  cache_of(options_, "motion"));
  const bool has_seen = is_given_by_what_is_seen(setting_.scene);
  if (motion_->needs_pass() || (has_seen && !motion_->knows_all())) {
    motion_->measure(reader_, options_.stop, {});
    reader_ = open_background(setting_.scene, options_);
  }
  if (has_seen)
    place_seen(
        setting_.scene,
        setting_.world,
        [&](const scene::Seen& seen) { return frame_near(*motion_, info_, seen); },
        options_.stop,
        setting_.inputs.get());
  ambient_.emplace(
      setting_.scene.light, tone_of(setting_.scene.camera_model), setting_.own_aircraft());
}

// ---------------------------------------------------------------- the stages of one frame

WorkPtr FrameMaker::decode() {
  if (options_.stop.stop_requested()) return nullptr;
  auto frame = reader_.next();
  if (!frame) return nullptr;
  auto work = std::make_shared<Work>();
  work->frame = std::move(*frame);
  return work;
}

void FrameMaker::locate(Work& work) {
  work.moved = motion_->next(work.frame);
  work.moment = moment_at(setting_.world, work.frame.index, work.frame.time_s, work.moved.shake);
  work.ambient = ambient_->next(
      work.frame.picture, work.moment.sight, search_bounds(work.moment), work.frame.begins_shot);
}

void FrameMaker::draw(Work& work) const {
  work.painted = setting_.painter->draw(work.moment, work.ambient);
}

void FrameMaker::compose(Work& work) {
  setting_.painter->compose(work.frame.picture, work.moment, work.ambient, work.painted);
}

void FrameMaker::describe(Work& work) const {
  const bool has_motion = setting_.scene.motion.model != scene::MotionModel::kNone;
  const char* state = has_motion ? motion::name(work.moved.motion.state) : "none";
  work.truth =
      frame_truth(setting_.world, work.frame, {state, work.moved.shake}, work.moment, work.painted);
  if (setting_.scene.output.masks)
    work.masks = mask_files(work.truth, work.painted.layer, setting_.own_aircraft(), setting_.size);
  work.painted = {};
}

}  // namespace airtruth::sequence
