// SPDX-License-Identifier: Apache-2.0
// The path of a frame through render(), from top to bottom: the inputs that are read before the
// first frame, the stages of one frame, and the output that is written after the last.
#include "sequence/sequence/sequence.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/stopwatch.h"
#include "picture/video/still.h"
#include "sequence/frame/frame_truth.h"
#include "sequence/frame/masks.h"
#include "sequence/frame/paint.h"
#include "sequence/sequence/input_files.h"
#include "sequence/sequence/outputs.h"
#include "sequence/sequence/resolve.h"
#include "sequence/sequence/staging.h"
#include "sequence/sequence/tally.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/world.h"
#include "sequence/surroundings/ambient.h"

namespace airtruth::sequence {
namespace {

// ---------------------------------------------------------------- before the first frame

// The folder in which motion is kept; empty: motion is not kept.
fs::path motion_cache(const Options& options) {
  if (!options.use_cache) return {};
  return options.cache.empty() ? cache_folder() / "motion" : options.cache;
}

video::Reader open(const scene::Scene& scene, const Options& options) {
  video::ReaderOptions reader_options;
  reader_options.first_frame = scene.background.first_frame;
  reader_options.frame_count = scene.background.frame_count;
  reader_options.threads = options.threads;
  reader_options.with_cuts = true;
  return video::Reader(scene.background.video, reader_options, options.warn);
}

lens::ImageSize size_of(const video::StreamInfo& info) { return {info.width, info.height}; }

// The stream with the number of frames that this run makes of it.
video::StreamInfo used_stream(video::StreamInfo info, const scene::Background& background) {
  const std::int64_t left =
      std::max<std::int64_t>(0, info.frame_count_estimate - background.first_frame);
  info.frame_count_estimate = left;
  if (background.frame_count)
    info.frame_count_estimate =
        left > 0 ? std::min(left, *background.frame_count) : *background.frame_count;
  return info;
}

// What every frame is made from. The painter refers to it, so it is neither copied nor moved.
struct Setting {
  Setting(const StatedScene& stated, const lens::ImageSize& image_size, const Options& options)
      : scene(stated.scene),
        size(image_size),
        mask(read_mask(scene, size)),
        world(load_world(scene, size, options.warn, options.stop)),
        painter(make_painter(
            scene, world, own_aircraft(), {options.gpu, options.software_gl, options.stop})) {
    scene.motion.model = motion_model(scene);
    // sequence.json records the scale that is drawn, so that the same scene gives the same sizes
    // whatever the table of published sizes becomes.
    for (std::size_t i = 0; i < world.actors.size(); ++i)
      if (const double scale = world.actors[i].type->catalogue_scale; scale != 1)
        scene.intruders[i].catalogue_scale = scale;
  }
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;

  const image::Mask* own_aircraft() const { return mask ? &*mask : nullptr; }

  scene::Scene scene;  // complete once complete_camera() has run: what sequence.json records
  lens::ImageSize size;
  std::optional<image::Mask> mask;
  World world;
  std::unique_ptr<Painter> painter;
};

// Gives the scene the exposure, noise and other values that [realism] leaves to the clip, which
// decodes the whole clip where they are not in the cache.
void complete_camera(Setting& setting,
                     StatedScene stated,
                     const video::StreamInfo& info,
                     const Options& options) {
  stated.scene = setting.scene;
  setting.scene = resolved(stated, setting.size, setting.own_aircraft(), options);
  check_codec(setting.scene, info.colour);
  setting.world.shutter = shutter_of(setting.scene.camera_model);
}

// The camera's motion. Decodes the frames once, and opens the reader again, where all motion must
// be known before the first frame and is not in the cache.
MotionSource measured_motion(const Setting& setting,
                             const std::string& video_sha256,
                             video::Reader& reader,
                             const Options& options) {
  MotionSource motion(setting.scene,
                      setting.world.lens,
                      !setting.world.shutter.is_instant(),
                      video_sha256,
                      setting.own_aircraft(),
                      motion_cache(options));
  if (motion.needs_pass()) {
    motion.measure(reader, options.stop, {});
    reader = open(setting.scene, options);
  }
  return motion;
}

// ---------------------------------------------------------------- the stages of one frame

struct Clocks {
  std::atomic<double> read = 0, move = 0, render = 0, composite = 0, write = 0;
};

// One frame on its way through the stages: each fills the members of its own.
struct Work {
  video::Frame frame;            // decode; compose changes its picture
  MotionSource::Measured moved;  // locate
  Moment moment;                 // locate
  Ambient ambient;               // locate
  Painted painted;               // draw, compose
  annotation::Frame truth;       // describe
  std::vector<MaskFile> masks;   // describe
};
using WorkPtr = std::shared_ptr<Work>;

// 1. decode: the next frame of the background; null after the last one, or on stop.
WorkPtr decode(video::Reader& reader, const Options& options) {
  if (options.stop.stop_requested()) return nullptr;
  auto frame = reader.next();
  if (!frame) return nullptr;
  auto work = std::make_shared<Work>();
  work->frame = std::move(*frame);
  return work;
}

// 2. locate: how the camera moved, where everything is, and the light that falls there. Frames come
// in order.
void locate(Work& work, const World& world, MotionSource& motion, AmbientEstimator& ambient) {
  work.moved = motion.next(work.frame);
  work.moment = moment_at(world, work.frame.index, work.frame.time_s, work.moved.shake);
  work.ambient = ambient.next(
      work.frame.picture, work.moment.sight, search_bounds(work.moment), work.frame.begins_shot);
}

// 3. draw: the intruders' light, coverage and depth on the frame's grid. Frames come in any order.
void draw(Work& work, const Painter& painter) {
  work.painted = painter.draw(work.moment, work.ambient);
}

// 4. compose: what was drawn is put into the picture. Frames come in order where a codec's mark
// follows from the frame before (Painter::is_in_order), else in any order.
void compose(Work& work, Painter& painter) {
  painter.compose(work.frame.picture, work.moment, work.ambient, work.painted);
}

// 5. describe: the frame's truth and masks, from the geometry and from what compositing changed.
void describe(Work& work, const Setting& setting) {
  const bool has_motion = setting.scene.motion.model != "none";
  const char* state = has_motion ? motion::name(work.moved.motion.state) : "none";
  work.truth =
      frame_truth(setting.world, work.frame, {state, work.moved.shake}, work.moment, work.painted);
  if (setting.scene.output.masks)
    work.masks = mask_files(work.truth, work.painted.layer, setting.own_aircraft(), setting.size);
  work.painted = {};
}

// 6. write: picture, truth and masks. Frames come in order.
void write(const Work& work, Outputs& outputs, Tally& tally) {
  outputs.write(work.frame, work.truth, work.masks);
  add_frame(tally, work.frame, work.moved.motion.state, work.truth);
}

// All frames through the six stages, as many at a time as there are threads; memory is bounded by
// the frames in flight.
Tally make_frames(Setting& setting,
                  video::Reader& reader,
                  MotionSource& motion,
                  Outputs& outputs,
                  std::int64_t total,
                  const Options& options,
                  Clocks& clocks) {
  Tally tally;
  AmbientEstimator ambient(
      setting.scene.light, tone_of(setting.scene.camera_model), setting.own_aircraft());
  Painter& painter = *setting.painter;
  const auto stopped = [&] { return options.stop.stop_requested(); };
  const auto decode_stage = [&](tbb::flow_control& control) {
    const Timed timed(clocks.read);
    WorkPtr work = decode(reader, options);
    if (!work) control.stop();
    return work;
  };
  const auto locate_stage = [&](WorkPtr work) {
    const Timed timed(clocks.move);
    locate(*work, setting.world, motion, ambient);
    return work;
  };
  const auto draw_stage = [&](WorkPtr work) {
    if (stopped()) return work;
    draw(*work, painter);
    clocks.render += work->painted.render_s;
    return work;
  };
  const auto compose_stage = [&](WorkPtr work) {
    if (stopped()) return work;
    const Timed timed(clocks.composite);
    compose(*work, painter);
    describe(*work, setting);
    return work;
  };
  const auto write_stage = [&](const WorkPtr& work) {
    if (stopped()) return;  // a frame that was not painted is not written
    const Timed timed(clocks.write);
    write(*work, outputs, tally);
    if (options.progress) options.progress({tally.frames, total});
  };

  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const std::size_t in_flight = 2 * static_cast<std::size_t>(threads) + 2;
  // OpenGL's context belongs to one thread: the chroma-key method runs in an arena of one.
  const bool one_thread = setting.scene.composite.method == "chroma-key";
  tbb::task_arena arena(one_thread ? 1 : threads);
  const auto in_order = tbb::filter_mode::serial_in_order;
  const auto draw_mode = one_thread ? in_order : tbb::filter_mode::parallel;
  const auto compose_mode = painter.is_in_order() ? in_order : draw_mode;
  arena.execute([&] {
    tbb::parallel_pipeline(in_flight,
                           tbb::make_filter<void, WorkPtr>(in_order, decode_stage) &
                               tbb::make_filter<WorkPtr, WorkPtr>(in_order, locate_stage) &
                               tbb::make_filter<WorkPtr, WorkPtr>(draw_mode, draw_stage) &
                               tbb::make_filter<WorkPtr, WorkPtr>(compose_mode, compose_stage) &
                               tbb::make_filter<WorkPtr, void>(in_order, write_stage));
  });
  if (stopped()) throw Interrupted();
  return tally;
}

// ---------------------------------------------------------------- after the last frame

Summary summary_of(const Tally& tally, const Clocks& clocks, bool motion_from_cache) {
  Summary summary;
  summary.frames = tally.frames;
  summary.frames_visible = tally.frames_visible;
  summary.frames_bridged = tally.frames_bridged;
  summary.frames_damaged = tally.frames_damaged;
  summary.stages = {clocks.read, clocks.move, clocks.render, clocks.composite, clocks.write};
  summary.motion_from_cache = motion_from_cache;
  return summary;
}

std::optional<tbb::global_control> thread_limit(int threads) {
  if (threads <= 0) return std::nullopt;
  return std::optional<tbb::global_control>(std::in_place,
                                            tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
}

}  // namespace

Summary render(const scene::Scene& scene, const fs::path& out, const Options& options) {
  const auto limit = thread_limit(options.threads);
  const fs::path folder = out / scene.name;
  StagedFolder staged(folder, options.overwrite);

  // All faults of the inputs are found here, before any long work.
  video::Reader reader = open(scene, options);
  const StatedScene stated_scene = stated(scene, reader.info());
  Setting setting(stated_scene, size_of(reader.info()), options);
  const video::StreamInfo info = used_stream(reader.info(), scene.background);
  check_camera_path(setting.world.camera, info);
  std::optional<Outputs> outputs;
  outputs.emplace(staged.path(), setting.scene, setting.world.lens, info, options.threads);

  // Quantities of the whole clip that are required before its first frame.
  complete_camera(setting, stated_scene, reader.info(), options);
  const std::string video_sha256 = sha256_of_video(scene.background.video);
  MotionSource motion = measured_motion(setting, video_sha256, reader, options);

  const Stopwatch running;
  Clocks clocks;
  const Tally tally =
      make_frames(setting, reader, motion, *outputs, info.frame_count_estimate, options, clocks);

  motion.store();
  warn_of_run(tally, setting.scene, setting.world, reader, options.warn);
  Summary summary = summary_of(tally, clocks, motion.from_cache());
  outputs->finish(setting.scene, input_files(scene, setting.world, video_sha256), summary);
  outputs.reset();
  staged.commit();
  summary.seconds = running.seconds();
  summary.folder = folder;
  return summary;
}

void measure_ahead(const scene::Scene& scene, const Options& options) {
  if (scene.motion.model == "none") return;
  video::Reader reader = open(scene, options);
  const auto mask = read_mask(scene, {reader.info().width, reader.info().height});
  const lens::Lens lens = lens_of(scene.lens, {reader.info().width, reader.info().height});
  MotionSource source(scene,
                      lens,
                      false,
                      sha256_of_video(scene.background.video),
                      mask ? &*mask : nullptr,
                      motion_cache(options));
  if (source.from_cache()) return;
  const std::int64_t total =
      scene.background.frame_count.value_or(reader.info().frame_count_estimate);
  source.measure(reader, options.stop, [&](std::int64_t done) {
    if (options.progress) options.progress({done, total});
  });
  source.store();
}

}  // namespace airtruth::sequence
