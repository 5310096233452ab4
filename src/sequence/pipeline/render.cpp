// SPDX-License-Identifier: Apache-2.0
// A run: the stages of frame_maker.h in a pipeline, the files that are written, and the warnings.
#include "sequence/pipeline/render.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "foundation/base/error.h"
#include "foundation/base/stopwatch.h"
#include "foundation/run_files/run_files.h"
#include "labels/annotation/object_class.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/paint.h"
#include "sequence/pipeline/encounter_record.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/pipeline/outputs.h"
#include "sequence/pipeline/staged_folder.h"
#include "sequence/setup/flyable.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/motion_source.h"

namespace airtruth::pipeline {
namespace {

// What a run counts while its frames pass.
struct Tally : FrameCounts {
  std::int64_t frames_turned = 0;  // of those bridged: turned beyond a homography's reach
  std::int64_t frames_black = 0;   // the light of the intruders is assumed
  // An occluder's horizon was put where the camera's attitude has it.
  std::int64_t frames_without_horizon = 0;
  std::vector<std::int64_t> cuts;  // frames that begin a shot
  // Per intruder with a range: the first frame that shows it; empty: never visible.
  std::vector<std::optional<FirstSeen>> first_seen;
  double last_time_s = 0;  // of the last frame
};

// Counts one more frame that has been through all stages; frames come in order.
void add_frame(Tally& tally, const Work& work) {
  const video::Frame& frame = work.frame;
  const annotation::Frame& truth = work.truth;
  const motion::State motion = work.moved.motion.state;
  ++tally.frames;
  tally.last_time_s = frame.time_s;
  tally.first_seen.resize(truth.intruders.size());
  bool any = false;
  for (std::size_t i = 0; i < truth.intruders.size(); ++i) {
    const bool visible = truth.intruders[i].state == annotation::State::kVisible;
    any = any || (visible && annotation::is_aircraft(truth.intruders[i].object_class));
    if (!tally.first_seen[i]) tally.first_seen[i] = seen_in(truth, truth.intruders[i]);
  }
  tally.frames_visible += any ? 1 : 0;
  tally.frames_bridged += motion::is_known(motion) ? 0 : 1;
  tally.frames_turned += motion == motion::State::kTurnedAway ? 1 : 0;
  tally.frames_damaged += frame.damaged ? 1 : 0;
  tally.frames_black += work.ambient.is_assumed ? 1 : 0;
  tally.frames_without_horizon += work.horizon_is_assumed ? 1 : 0;
  if (frame.begins_shot) tally.cuts.push_back(frame.index);
}

// A turn may bring an intruder nearer within the clip than at the closest approach that its scene
// states.
void warn_nearer(const scene::Intruder& intruder,
                 const setup::Actor& actor,
                 const trajectory::Path& own,
                 double last_time_s,
                 const Warn& to_warn) {
  constexpr double kNearerM = 0.1;  // a smaller difference is not worth a warning: chosen
  if (!intruder.encounter) return;
  const double cpa_time_s = intruder.encounter->cpa_time_s;
  const auto stated = passage::closest_approach(own, actor.path, cpa_time_s, cpa_time_s);
  const auto nearest = passage::closest_approach(own, actor.path, 0, last_time_s);
  if (!stated || !nearest || nearest->distance_m > stated->distance_m - kNearerM) return;
  warn(to_warn,
       fmt::format("{}: intruder '{}' comes nearer than at its cpa_time_s of {:.2f} s: {:.1f} m in "
                   "place of {:.1f} m, at {:.2f} s",
                   to_string(intruder.where),
                   actor.id,
                   cpa_time_s,
                   nearest->distance_m,
                   stated->distance_m,
                   nearest->time_s));
}

void warn_never_seen(const scene::Intruder& intruder,
                     const setup::World& world,
                     std::size_t i,
                     double last_time_s,
                     const Warn& to_warn) {
  std::string text =
      to_string(intruder.where) + ": intruder '" + world.actors[i].id + "' is never visible";
  const auto nearest = setup::nearest_approach(world, i, last_time_s);
  if (nearest && nearest->off_view_deg <= 0) {
    text += fmt::format(
        "; it is in view at {:.2f} s, but changes no pixel there: something hides it, or it is as "
        "bright as the picture behind it",
        nearest->time_s);
  } else if (nearest) {
    text += fmt::format(
        "; it comes nearest to the view's edge at {:.2f} s, {:.1f} degrees from it, at a range of "
        "{:.0f} m",
        nearest->time_s,
        nearest->off_view_deg,
        nearest->range_m);
  } else {
    text += "; its path does not overlap the clip in time";
  }
  warn(to_warn, text);
}

void warn_of_video(const Tally& tally,
                   const scene::Background& background,
                   const video::Reader& reader,
                   const Warn& to_warn) {
  const std::string video = background.video.string();
  if (reader.corrupt_packets() > 0 || tally.frames_damaged > 0)
    warn(to_warn,
         fmt::format("{}: {} corrupt packets; {} frames are flagged damaged",
                     video,
                     reader.corrupt_packets(),
                     tally.frames_damaged));
  if (tally.frames_black > 0)
    warn(to_warn,
         fmt::format("{}: {} frames are black, and show no light; there the intruders have that of "
                     "an overcast sky, or what [light] states",
                     video,
                     tally.frames_black));
  if (reader.ends_early())
    warn(to_warn, fmt::format("{}: ends early, after {} frames", video, tally.frames));
  if (background.frame_count && tally.frames < *background.frame_count)
    warn(to_warn,
         fmt::format("{}: frame_count is {}, but the video holds {} frames from first_frame on",
                     to_string(background.where),
                     *background.frame_count,
                     tally.frames));
}

void warn_of_motion(const Tally& tally, const scene::Background& background, const Warn& to_warn) {
  if (tally.frames_bridged > 0)
    warn(
        to_warn,
        fmt::format("the camera's motion could not be measured in {} frames; they are bridged, and "
                    "truth.jsonl says which",
                    tally.frames_bridged));
  if (!tally.cuts.empty())
    warn(to_warn,
         fmt::format(
             "{}: the video is cut at frame {}: nothing links the camera's pose and light to "
             "the frames before",
             background.video.string(),
             fmt::join(tally.cuts, ", ")));
  if (tally.frames_turned > 0)
    warn(to_warn,
         fmt::format(
             "in {} of them the camera has turned so far from the first frame that no homography "
             "holds "
             "both; expected [motion] reference = \"smoothed\", or model = \"rotation\" with the "
             "camera's lens",
             tally.frames_turned));
}

// Warns of what a user should know about a finished run: corrupt or missing frames, bridged motion,
// cuts, horizons that were not found, intruders that fly below the ground or beyond their type's
// limits, that come nearer than their stated closest approach, and that are never visible.
void warn_of_run(const Tally& tally,
                 const scene::Scene& scene,
                 const setup::World& world,
                 const video::Reader& reader,
                 const Warn& to_warn) {
  warn_of_video(tally, scene.background, reader, to_warn);
  warn_of_motion(tally, scene.background, to_warn);
  if (tally.frames_without_horizon > 0)
    warn(to_warn,
         fmt::format("[[occluder]] beyond_horizon: {} frames show no horizon; in them it is where "
                     "the camera's attitude and its measured motion have it",
                     tally.frames_without_horizon));
  setup::warn_below_ground(scene, world, tally.last_time_s, to_warn);
  for (std::size_t i = 0; i < world.actors.size(); ++i) {
    setup::warn_not_flyable(scene.intruders[i], world.actors[i].path, tally.last_time_s, to_warn);
    warn_nearer(scene.intruders[i], world.actors[i], world.camera, tally.last_time_s, to_warn);
    if (i >= tally.first_seen.size() || !tally.first_seen[i])
      warn_never_seen(scene.intruders[i], world, i, tally.last_time_s, to_warn);
  }
}

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
    outputs.write(work->frame, work->truth, work->masks);
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
  Summary summary{tally};
  summary.stages = times_of(clocks);
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
