// SPDX-License-Identifier: Apache-2.0
#include "studio/session/stage.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foundation/base/error.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/level_camera.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::session {
namespace {

// After so many frames the light no longer depends on where its estimate began: a new frame has a
// weight of 0.1 (sequence/insertion/ambient.cpp), and 0.9^240 is 1e-11, beyond the digits of float.
constexpr std::int64_t kLightFrames = 240;
// A step ahead that the light follows at once.
constexpr std::int64_t kFollowed = 8;
constexpr std::size_t kMostLights = 64;

// The text of a scene that has the background alone, and what `take` puts into it: the same for two
// scenes exactly where all of that is.
template <typename Take>
std::string key_of(const scene::Scene& scene, const Take& take) {
  scene::Scene part;
  part.seed = scene.seed;
  part.background = scene.background;
  take(part);
  return scene::toml_from_scene(part);
}

std::string attitude_key_of(const scene::Scene& scene) {
  return key_of(scene, [&](scene::Scene& part) {
    part.lens = scene.lens;
    part.camera = scene.camera;
    part.motion = scene.motion;
  });
}

std::string light_key_of(const scene::Scene& scene) {
  return key_of(scene, [&](scene::Scene& part) {
    part.lens = scene.lens;
    part.camera = scene.camera;
    part.light = scene.light;
    part.camera_model.gamma = scene.camera_model.gamma;
  });
}

}  // namespace

std::string motion_key(const scene::Scene& scene) {
  return key_of(scene, [&](scene::Scene& part) {
    part.lens = scene.lens;
    part.motion = scene.motion;
    // Whether there is a shutter.
    part.camera_model.exposure_s = scene.camera_model.exposure_s;
    part.camera_model.readout_s = scene.camera_model.readout_s;
    part.camera_model.angle_deg = scene.camera_model.angle_deg;
  });
}

std::string calibration_key(const scene::Scene& scene) {
  return key_of(scene, [&](scene::Scene& part) {
    part.lens = scene.lens;
    // Of the camera's place the height alone counts.
    part.camera.position_ned_m = {0, 0, scene.camera.position_ned_m.z()};
    part.camera.path_file = scene.camera.path_file;
    part.camera.log = scene.camera.log;
    part.camera_model.gamma = scene.camera_model.gamma;
  });
}

Stage::Stage(pipeline::Options options) : options_(std::move(options)) {
  options_.is_preview = true;
  options_.warn = [this](const std::string& line) { warnings_.push_back(line); };
}
Stage::~Stage() = default;

Clip& Stage::clip(const scene::Background& background) {
  const std::string key = text_of(background);
  if (!clip_ || key != clip_key_) {
    clip_.reset();
    clip_ = std::make_unique<Clip>(background, options_);
    clip_key_ = key;
    last_light_.clear();
  }
  return *clip_;
}

void Stage::set(std::int64_t revision, const scene::Scene& scene, const Measured& measured) {
  const std::string measured_as = fmt::format("{} {} {}",
                                              static_cast<const void*>(measured.motion.get()),
                                              measured.motion_key,
                                              fmt::join(measured.calibrated, " "));
  if (maker_ && revision == revision_ && measured_as == measured_as_) return;
  maker_.reset();
  warnings_.clear();
  open(scene, measured);
  revision_ = revision;
  measured_as_ = measured_as;
}

// The camera's attitude by the horizon is looked for once.
scene::Scene Stage::with_attitude(const scene::Scene& scene) {
  scene::Scene result = scene;
  const std::string key = attitude_key_of(scene);
  if (key != attitude_key_) {
    const lens::ImageSize size{clip_->info().width, clip_->info().height};
    setup::take_pixel_shape(result.lens, size, clip_->info().sample_aspect.value());
    std::shared_ptr<const image::Mask> mask;
    if (scene.background.mask) mask = options_.shared->mask_of(*scene.background.mask, size);
    camera_ = scene.camera;
    attitude_words_ = setup::state_attitude(
        camera_,
        setup::lens_of(result.lens, size),
        mask.get(),
        [&] { return pipeline::open_background(scene, options_); },
        options_.stop);
    attitude_key_ = key;
  }
  result.camera = camera_;
  return result;
}

// The camera's values as far as they are measured; else they are left out.
bool Stage::take_camera(pipeline::OpenedScene& opened, bool is_calibrated) {
  if (opened.stated.to_measure.empty()) return true;
  if (!is_calibrated) return false;
  pipeline::measure_camera(opened, options_);
  opened.stated.scene.camera_model.codec_step.reset();
  return true;
}

void Stage::open(const scene::Scene& scene, const Measured& measured) {
  clip(scene.background);
  const scene::Scene standing = with_attitude(scene);
  pipeline::OpenedScene opened = pipeline::open_over(clip_->info(), standing, options_);
  const bool has_camera =
      take_camera(opened, measured.calibrated.count(calibration_key(scene)) > 0);
  motion_ = measured.motion && measured.motion_key == motion_key(scene) ? measured.motion : nullptr;
  if (motion_) pipeline::place_seen(opened, *motion_, options_.stop);
  has_motion_ = motion_ || opened.stated.scene.motion.model == scene::MotionModel::kNone;
  is_complete_ = has_camera && has_motion_;
  seen_.clear();
  for (const scene::Intruder& intruder : scene.intruders) seen_.push_back(intruder.seen);
  tone_ = setup::tone_of(opened.stated.scene.camera_model);
  const std::string light_key = light_key_of(opened.stated.scene);
  if (light_key != light_key_) last_light_.clear();
  light_key_ = light_key;
  estimator_.reset();
  maker_ = std::make_unique<pipeline::FrameMaker>(pipeline::resolved_by_truth(std::move(opened)),
                                                  options_.stop);
}

std::optional<projection::Sight> Stage::sight_at(std::int64_t frame) const {
  const setup::World& seen = world();
  const double at_s = time_s(frame);
  const auto camera = seen.camera.at(at_s);
  if (!camera) return std::nullopt;
  return setup::sight_of(seen.lens, seen.shutter, seen.camera, *camera, at_s, shake_at(frame));
}

Shake Stage::shake_at(std::int64_t frame) const {
  if (!motion_ || motion_->all().empty()) return {};
  const std::int64_t last = std::ssize(motion_->all()) - 1;
  return motion_->at(static_cast<std::size_t>(std::clamp<std::int64_t>(frame, 0, last))).shake;
}

double Stage::time_s(std::int64_t frame) const {
  if (motion_ && frame >= 0 && frame < std::ssize(motion_->all()))
    return motion_->all()[static_cast<std::size_t>(frame)].time_s;
  const std::vector<double>& times_s = clip_->times_s();
  if (frame >= 0 && frame < std::ssize(times_s)) return times_s[static_cast<std::size_t>(frame)];
  return static_cast<double>(frame) / clip_->rate_hz();
}

double Stage::duration_s() const {
  if (!clip_->times_s().empty()) return clip_->times_s().back();
  return static_cast<double>(clip_->frame_count() - 1) / clip_->rate_hz();
}

setup::Moment Stage::moment(std::int64_t frame) {
  return setup::moment_at(world(), frame, clip_->time_s(frame), shake_at(frame));
}

insertion::Ambient Stage::next_light(std::int64_t frame, const setup::Moment& moment) {
  light_frame_ = frame;
  return estimator_->next(clip_->glance(frame, tone_),
                          moment.sight,
                          setup::search_bounds(moment),
                          clip_->begins_shot(frame));
}

std::optional<Stage::Lit> Stage::light(std::int64_t frame,
                                       const setup::Moment& moment,
                                       bool exact,
                                       const std::function<bool()>& leave) {
  const auto begin = [&](std::int64_t first) {
    estimator_.emplace(scene().light, scene().camera_model, maker_->resolved().mask.get());
    light_first_ = first;
    light_frame_ = first - 1;
  };
  if (!estimator_) begin(frame);
  if (!estimator_->reads_pictures()) return Lit{next_light(frame, moment), true};
  const auto is_exact = [&] { return light_first_ == 0 || frame - light_first_ >= kLightFrames; };
  const std::int64_t ahead = frame - light_frame_;
  const bool follows =
      ahead > 0 && (exact ? is_exact() && ahead <= kLightFrames : ahead <= kFollowed);
  if (!follows && !exact) {
    if (const auto last = last_light_.find(frame); last != last_light_.end())
      return Lit{last->second, false};
    begin(frame);
  } else if (!follows) {
    begin(std::max<std::int64_t>(0, frame - kLightFrames));
  }
  for (std::int64_t k = light_frame_ + 1; k < frame; ++k) {
    if (leave && leave()) return std::nullopt;
    if (!clip_->has_glance(k)) clip_->frame(k);
    next_light(k, this->moment(k));
  }
  const Lit lit{next_light(frame, moment), is_exact()};
  if (!lit.exact) return lit;
  if (last_light_.size() >= kMostLights) last_light_.clear();
  last_light_[frame] = lit.ambient;
  return lit;
}

std::optional<Stage::Picture> Stage::picture(std::int64_t frame,
                                             bool exact,
                                             const std::function<bool()>& leave) {
  check(maker_ != nullptr, "a scene is set up");
  Picture result;
  result.plain = clip_->frame(frame);
  result.moment = moment(frame);
  const auto is_there = [](const auto& one) { return one.has_value(); };
  const bool has_any = std::ranges::any_of(result.moment.search, is_there) ||
                       std::ranges::any_of(result.moment.spots, is_there);
  result.exact = is_complete_;
  if (!has_any) return result;
  const auto lit = light(frame, result.moment, exact, leave);
  if (!lit) return std::nullopt;
  pipeline::Work work;
  work.frame.index = frame;
  work.frame.time_s = result.plain->time_s;
  work.frame.picture = result.plain->picture.clone();
  work.moment = result.moment;
  work.ambient = lit->ambient;
  maker_->draw(work);
  maker_->compose(work);
  result.plain.reset();
  result.made = std::move(work.frame.picture);
  result.exact = lit->exact && is_complete_;
  return result;
}

}  // namespace airtruth::session
