// SPDX-License-Identifier: Apache-2.0
// A run: the stages of frame_maker.h in a pipeline, the files that are written, and the warnings.
#include "sequence/pipeline/render.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <set>
#include <vector>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "camera/lens/lens.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/stopwatch.h"
#include "foundation/json/or_null.h"
#include "foundation/run_files/run_files.h"
#include "labels/annotation/evision.h"
#include "labels/annotation/object_class.h"
#include "labels/annotation/truth.h"
#include "picture/composite/cover.h"
#include "picture/video/reader.h"
#include "picture/video/still.h"
#include "picture/video/writer.h"
#include "scene/scene/camera_keys.h"
#include "sequence/insertion/masks.h"
#include "sequence/insertion/paint.h"
#include "sequence/pipeline/encounter_record.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/pipeline/staged_folder.h"
#include "sequence/setup/flyable.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/shared_inputs.h"
#include "show/drawing/pictures.h"

namespace airtruth::pipeline {
namespace {

annotation::EvisionFrame evision_frame(const annotation::Frame& truth,
                                       const annotation::Intruder& intruder) {
  annotation::EvisionFrame frame;
  frame.number = static_cast<int>(truth.frame) + 1;
  frame.intruder_ned_m = vector_of(*intruder.position_ned_m);
  frame.distance_m = *intruder.range_m;
  if (intruder.covered_box_px) frame.rect_px = *intruder.covered_box_px;
  return frame;
}

// Adds an input or output file with its SHA-256 to a list of sequence.json.
void add_file(nlohmann::ordered_json& list, const fs::path& name, const std::string& sha256) {
  list.push_back({{"name", name.string()}, {"sha256", sha256}});
}

// Checksums of the files of a folder, and of the images in its sub-folders, by name.
nlohmann::ordered_json checksums_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  nlohmann::ordered_json result = nlohmann::ordered_json::array();
  for (const fs::path& file : files)
    add_file(result, fs::relative(file, folder), sha256_of_file(file));
  return result;
}

// Writes the output of a run (docs/formats/output.md) frame by frame into the staged folder.
class Outputs {
 public:
  Outputs(const fs::path& folder,
          const scene::Scene& scene,
          const lens::Lens& lens,
          const video::StreamInfo& info,
          int threads)
      : folder_(folder),
        lens_(lens::facts_of(lens)),
        writer_(folder / (scene.name + video::extension(scene.output.video)),
                info,
                {.format = scene.output.video,
                 .quality = scene.output.quality,
                 .keyframe_s = scene.output.keyframe_s,
                 .threads = threads,
                 .encoder = scene.output.encoder,
                 .encoder_where = scene.output.encoder_where}),
        truth_(folder / "truth.jsonl", std::ios::binary),
        aircraft_(
            static_cast<std::size_t>(std::ranges::count_if(scene.intruders, scene::is_aircraft))),
        sheet_(scene.name, info.frame_count_estimate) {
    check_truth("create");
    const std::size_t files = std::max<std::size_t>(1, aircraft_);
    for (std::size_t i = 0; i < files; ++i) {
      const std::string suffix = files == 1 ? "" : "-" + scene.intruders[i].id;
      evision_.emplace_back(folder / (scene.name + suffix + ".xml"));
    }
  }

  void write(const video::Frame& frame,
             const annotation::Frame& truth,
             const std::vector<insertion::MaskFile>& masks) {
    writer_.write(frame);
    for (const insertion::MaskFile& mask : masks) {
      fs::create_directories((folder_ / mask.name).parent_path());
      write_file(folder_ / mask.name, mask.png, Flush::kLater);
    }
    truth_ << annotation::jsonl_line(truth, lens_) << '\n';
    check_truth("write");
    const Vector3 camera_ned_m = vector_of(truth.camera_position_ned_m);
    // The format is one of aircraft, which come first.
    if (aircraft_ == 0) evision_[0].add(std::nullopt, camera_ned_m);
    for (std::size_t i = 0; i < aircraft_; ++i) {
      const annotation::Intruder& intruder = truth.intruders[i];
      evision_[i].add(intruder.state == annotation::State::kEnded
                          ? std::nullopt
                          : std::optional(evision_frame(truth, intruder)),
                      camera_ned_m);
    }
    sheet_.add(frame.picture, truth);
  }

  // Closes all files and writes the annotation, the preview and, last, sequence.json. `scene` is
  // the resolved scene.
  void finish(const scene::Scene& scene,
              const nlohmann::ordered_json& inputs,
              const std::vector<EncounterRecord>& encounters,
              const Summary& summary) {
    writer_.finish();
    truth_.close();
    check_truth("write");
    for (annotation::EvisionWriter& file : evision_) file.finish();
    video::write_still(folder_ / "preview.jpg", sheet_.sheet());
    if (scene.output.masks) flush_files(folder_);
    nlohmann::ordered_json record;
    record["format"] = "airtruth sequence 1";
    record["version"] = kVersion;
    record["name"] = scene.name;
    record["seed"] = scene.seed;
    record["weight"] = or_null(scene.weight);
    if (const auto weather = scene::weather_facts(scene); !weather.empty())
      record["weather"] = weather;
    record["encoder"] = writer_.encoder();
    record["covered_alpha"] = composite::kCoveredAlpha / 255.0;
    record["scene_toml"] = scene::toml_from_scene(scene);
    record["inputs"] = inputs;
    record["outputs"] = checksums_below(folder_);
    record["summary"] = {{"frames", summary.frames},
                         {"frames_with_an_intruder_visible", summary.frames_visible},
                         {"frames_with_bridged_motion", summary.frames_bridged},
                         {"frames_damaged_in_the_background", summary.frames_damaged}};
    record["encounters"] = json_of(encounters);
    write_file(folder_ / "sequence.json", record.dump(2) + "\n");
  }

 private:
  // Throws Error where the truth could not be written so far.
  void check_truth(const char* what) const {
    if (!truth_)
      throw Error(fmt::format("cannot {}: {}", what, std::strerror(errno)),
                  {(folder_ / "truth.jsonl").string()});
  }

  fs::path folder_;
  lens::Facts lens_;
  video::Writer writer_;
  std::ofstream truth_;
  std::size_t aircraft_ = 0;  // of the scene's intruders, which they are the first of
  // By aircraft. A scene without aircraft has one file whose frames have no position.
  std::vector<annotation::EvisionWriter> evision_;
  drawing::ContactSheet sheet_;
};

// The files of the aircraft's models, by name.
std::vector<fs::path> model_files(const setup::World& world) {
  std::set<fs::path> models;
  for (const setup::Actor& actor : world.actors)
    models.insert(actor.type->aircraft->sources.begin(), actor.type->aircraft->sources.end());
  return {models.begin(), models.end()};
}

// Every file that a run reads, with its SHA-256, for sequence.json: video, mask, camera file, lens
// file, path files, masks of occluders, and the files of the aircraft's models by name. `scene` is
// the one the user gave. An empty `video_sha256` is left out. A series of pictures has one SHA-256.
nlohmann::ordered_json input_files(const scene::Scene& scene,
                                   const setup::World& world,
                                   const std::string& video_sha256,
                                   setup::SharedInputs& inputs) {
  nlohmann::ordered_json result = nlohmann::ordered_json::array();
  // Under the names that scene_toml has, wherever the run was called.
  const auto add_with = [&](const fs::path& file, const std::string& sha256) {
    add_file(result, absolute_path(file), sha256);
  };
  const auto add = [&](const fs::path& file) { add_with(file, inputs.sha256_of_file(file)); };
  if (!video_sha256.empty()) add_with(scene.background.video, video_sha256);
  std::set<fs::path> masks;
  for (const scene::Occluder& occluder : scene.occluders)
    if (occluder.mask && masks.insert(*occluder.mask).second)
      add_with(*occluder.mask, setup::sha256_of_video(*occluder.mask, inputs));
  for (const auto& [file, where] : scene::stated_files(scene))
    if (file != scene.background.video && !masks.contains(file)) add(file);
  for (const fs::path& model : model_files(world)) add(model);
  return result;
}

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
  tally.frames_without_horizon += work.painted.horizon_is_assumed ? 1 : 0;
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
        "; it is in view at {:.2f} s, at a range of {:.0f} m, but changes no pixel there: it is "
        "too small, something hides it, or it is as bright as the picture behind it",
        nearest->time_s,
        nearest->range_m);
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

void warn_of_video(const Tally& tally, const scene::Background& background, const Warn& to_warn) {
  const std::string video = background.video.string();
  if (tally.frames_black > 0)
    warn(to_warn,
         fmt::format("{}: {} frames are black, and show no light; there the intruders have that of "
                     "an overcast sky, or what [light] states",
                     video,
                     tally.frames_black));
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
             "{}: the clip is cut at its frame {}: nothing links the camera's pose and light to "
             "the frames before",
             background.video.string(),
             fmt::join(tally.cuts, ", ")));
  if (tally.frames_turned > 0)
    warn(to_warn,
         fmt::format(
             "in {} of them the camera has turned or flown so far from the first frame that no "
             "homography holds both; expected [motion] reference = \"smoothed\", or model = "
             "\"rotation\" with the camera's lens",
             tally.frames_turned));
}

// Warns of what a user should know about a finished run: black or missing frames, bridged motion,
// cuts, horizons that were not found, intruders that fly below the ground or beyond their type's
// limits, that come nearer than their stated closest approach, and that are never visible.
void warn_of_run(const Tally& tally,
                 const scene::Scene& scene,
                 const setup::World& world,
                 const Warn& to_warn) {
  warn_of_video(tally, scene.background, to_warn);
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
  const bool one_thread =
      maker.resolved().scene.composite.method == scene::CompositeMethod::kChromaKey;
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

}  // namespace

Summary render(const scene::Scene& scene, const fs::path& out, const Options& options) {
  Clocks clocks;
  std::optional<tbb::global_control> limit;
  if (options.threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism,
                  static_cast<std::size_t>(options.threads));
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
  // What could not be read again is an error before its frames are made.
  scene::parse_scene(scene::toml_from_scene(resolved.scene), folder / "sequence.json");

  const Stopwatch running;
  clocks.frames_s = process_cpu_seconds();
  const Tally tally = make_frames(maker, *outputs, options, clocks);
  clocks.end_s = process_cpu_seconds();

  maker.store_motion();
  warn_of_run(tally, resolved.scene, resolved.world, options.warn);
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
