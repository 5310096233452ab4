// SPDX-License-Identifier: Apache-2.0
// A run: the stages of frame_maker.h in a pipeline, and the files that are written.
#include "sequence/pipeline/render.h"

#include <algorithm>
#include <memory>
#include <optional>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "foundation/base/error.h"
#include "foundation/base/stopwatch.h"
#include "foundation/run_files/run_files.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/paint.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/pipeline/outputs.h"
#include "sequence/pipeline/staged_folder.h"
#include "sequence/pipeline/tally.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/motion_source.h"

namespace airtruth::pipeline {
namespace {

struct Clocks {
  SharedTime read, move, render, composite, write;
  // CPU time of the process when the run began, when its frames began, and when they ended.
  double begin_s = process_cpu_seconds(), frames_s = 0, end_s = 0;
};

// All frames through the stages of FrameMaker, each timed, and then into the files, as many at a
// time as there are threads; memory is bounded by the frames in flight. After a stop no stage works
// on, so that a frame that is not whole is not written.
Tally make_frames(FrameMaker& maker, Outputs& outputs, const Options& options, Clocks& clocks) {
  Tally tally;
  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  // One for each thread, one that waits for its turn and one that is being decoded. With more, a
  // long run comes to hold them all at some time, and takes no less time.
  const std::size_t in_flight = static_cast<std::size_t>(threads) + 2;
  // OpenGL's context belongs to one thread: the chroma-key method runs in an arena of one.
  const bool one_thread = maker.is_of_one_thread();
  tbb::task_arena arena(one_thread ? 1 : threads);
  const auto in_order = tbb::filter_mode::serial_in_order;
  const auto draw_mode = one_thread ? in_order : tbb::filter_mode::parallel;
  const auto compose_mode = maker.composes_in_order() ? in_order : draw_mode;
  const auto decode = tbb::make_filter<void, WorkPtr>(in_order, [&](tbb::flow_control& control) {
    const Timed timed(clocks.read);
    WorkPtr work = maker.decode();
    if (!work) control.stop();
    return work;
  });
  const auto stage = [&](tbb::filter_mode mode, SharedTime& time, const auto& run) {
    return tbb::make_filter<WorkPtr, WorkPtr>(mode, [&options, &time, run](WorkPtr work) {
      if (options.stop.stop_requested()) return work;
      const Timed timed(time);
      run(*work);
      return work;
    });
  };
  const auto locate = stage(in_order, clocks.move, [&](Work& work) { maker.locate(work); });
  const auto draw = stage(draw_mode, clocks.render, [&](Work& work) { maker.draw(work); });
  const auto compose = stage(compose_mode, clocks.composite, [&](Work& work) {
    maker.compose(work);
    maker.describe(work);
  });
  const auto write = tbb::make_filter<WorkPtr, void>(in_order, [&](const WorkPtr& work) {
    if (options.stop.stop_requested()) return;
    const Timed timed(clocks.write);
    const std::shared_ptr<const video::Frame> frame(work, &work->frame);
    outputs.write(frame, work->truth, work->masks);
    add_frame(tally, *work);
    if (options.progress)
      options.progress({tally.frames, maker.resolved().info.frame_count_estimate});
  });
  arena.execute(
      [&] { tbb::parallel_pipeline(in_flight, decode & locate & draw & compose & write); });
  if (options.stop.stop_requested()) throw Interrupted();
  return tally;
}

StageTimes times_of(const Clocks& clocks) {
  const auto time_of = [](const SharedTime& time) { return StageTime{time.wall_s, time.cpu_s}; };
  StageTimes times{time_of(clocks.read),
                   time_of(clocks.move),
                   time_of(clocks.render),
                   time_of(clocks.composite),
                   time_of(clocks.write)};
  const double of_stages_s = times.read.cpu_s + times.move.cpu_s + times.render.cpu_s +
                             times.composite.cpu_s + times.write.cpu_s;
  times.other_threads_cpu_s = std::max(0.0, clocks.end_s - clocks.frames_s - of_stages_s);
  times.start_cpu_s = clocks.frames_s - clocks.begin_s;
  return times;
}

Summary summary_of(const Tally& tally, const Clocks& clocks, bool motion_from_cache) {
  Summary summary;
  summary.frames = tally.frames;
  summary.frames_visible = tally.frames_visible;
  summary.frames_bridged = tally.frames_bridged;
  summary.frames_damaged = tally.frames_damaged;
  summary.stages = times_of(clocks);
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
  Clocks clocks;
  const auto limit = thread_limit(options.threads);
  const fs::path folder = out / scene.name;
  RunFiles files;
  for (const fs::path& file : setup::files_read(scene)) files.reads(file);
  files.replaces(folder).check();
  StagedFolder staged(folder, options.overwrite, options.warn);

  // All faults of the inputs are found before any long work, and whether they can be written.
  OpenedScene opened = open_scene(scene, options);
  for (const fs::path& model : model_files(opened.world)) files.reads(model);
  files.check();
  std::optional<Outputs> outputs;
  outputs.emplace(
      staged.path(), opened.stated.scene, opened.world.lens, opened.info, options.threads);
  FrameMaker maker(resolve(std::move(opened), options), options.stop);
  const ResolvedScene& resolved = maker.resolved();

  const Stopwatch running;
  clocks.frames_s = process_cpu_seconds();
  const Tally tally = make_frames(maker, *outputs, options, clocks);
  clocks.end_s = process_cpu_seconds();

  maker.store_motion();
  warn_of_run(tally, resolved.scene, resolved.world, *resolved.background, options.warn);
  Summary summary = summary_of(tally, clocks, resolved.motion->is_from_cache());
  summary.notes = resolved.notes;
  outputs->finish(resolved.scene,
                  input_files(scene, resolved.world, resolved.video_sha256, *resolved.inputs),
                  encounter_records(resolved.world, tally.first_seen, tally.last_time_s),
                  summary);
  outputs.reset();
  staged.commit();
  summary.stages.end_cpu_s = process_cpu_seconds() - clocks.end_s;
  summary.seconds = running.seconds();
  summary.folder = folder;
  return summary;
}

}  // namespace airtruth::pipeline
