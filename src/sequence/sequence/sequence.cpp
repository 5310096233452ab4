// SPDX-License-Identifier: Apache-2.0
#include "sequence/sequence/sequence.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include <fmt/ranges.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/still.h"
#include "sequence/sequence/ambient.h"
#include "sequence/sequence/flyable.h"
#include "sequence/sequence/masks.h"
#include "sequence/sequence/motion_source.h"
#include "sequence/sequence/outputs.h"
#include "sequence/sequence/paint.h"
#include "sequence/sequence/resolve.h"
#include "sequence/sequence/staging.h"
#include "sequence/sequence/stopwatch.h"
#include "sequence/sequence/world.h"

namespace airtruth::sequence {
namespace {

// Where motion is kept; empty: nowhere.
fs::path cache_of(const Options& options) {
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

// One frame on its way through the pipeline.
struct Work {
  video::Frame frame;
  motion::FrameMotion motion;
  Ambient ambient;
  Moment moment;
  Painted painted;
  annotation::Frame truth;
  std::vector<MaskFile> masks;
};
using WorkPtr = std::shared_ptr<Work>;

class Run {
 public:
  Run(const scene::Scene& scene, const fs::path& folder, const Options& options)
      : options_(options),
        camera_file_(scene.realism.file),
        staged_(folder, options.overwrite),
        reader_(open(scene, options)),
        size_{reader_.info().width, reader_.info().height},
        mask_(read_mask(scene, size_)),
        stated_(stated(scene, reader_.info())),
        scene_(stated_.scene),
        world_(load_world(scene_, size_, options.warn, options.stop)),
        painter_(make_painter(scene_, world_, mask_ptr(), options)) {
    scene_.motion.model = stated_.scene.motion.model = motion_model(scene_);
    // What was drawn is recorded: the same scene gives the same sizes whatever the table becomes.
    for (std::size_t i = 0; i < world_.actors.size(); ++i)
      if (const double scale = world_.actors[i].type->catalogue_scale; scale != 1)
        scene_.intruders[i].catalogue_scale = stated_.scene.intruders[i].catalogue_scale = scale;
    const video::StreamInfo info = stream_info();
    check_camera_path(world_.camera, info);
    outputs_.emplace(staged_.path(), scene_, world_.lens, info, options_.threads);
    seen_.assign(world_.actors.size(), false);
    // All that can be wrong with the inputs is known here; what follows takes long.
    measure_camera();
    measure_motion();
  }

  Summary run() {
    const Stopwatch running;
    run_pipeline();
    if (options_.stop.stop_requested()) throw Interrupted();
    motion_->store();
    say_what_was_odd();
    summary_.motion_from_cache = motion_->from_cache();
    outputs_->finish(scene_, inputs(), summary_);
    outputs_.reset();
    staged_.commit();
    summary_.seconds = running.seconds();
    summary_.stages = {
        clocks_.read, clocks_.move, clocks_.render, clocks_.composite, clocks_.write};
    return summary_;
  }

 private:
  const image::Mask* mask_ptr() const { return mask_ ? &*mask_ : nullptr; }

  // Exposure, noise and what else [realism] leaves to the clip.
  void measure_camera() {
    scene_ = resolved(stated_, size_, mask_ptr(), options_);
    check_codec(scene_, reader_.info().colour);
    world_.shutter = shutter_of(scene_.camera_model);
    ambient_.emplace(scene_.light, tone_of(scene_.camera_model), mask_ptr());
  }

  // The camera's motion where all of it must be known before the first frame.
  void measure_motion() {
    video_sha256_ = sha256_of_video(scene_.background.video);
    motion_.emplace(scene_,
                    world_.lens,
                    !world_.shutter.is_instant(),
                    video_sha256_,
                    mask_ptr(),
                    cache_of(options_));
    if (!motion_->needs_pass()) return;
    motion_->measure(reader_, options_.stop, {});
    reader_ = open(scene_, options_);
  }

  // The stream, with the number of frames that this run will make of it.
  video::StreamInfo stream_info() const {
    video::StreamInfo info = reader_.info();
    const std::int64_t left =
        std::max<std::int64_t>(0, info.frame_count_estimate - scene_.background.first_frame);
    info.frame_count_estimate = left;
    if (scene_.background.frame_count)
      info.frame_count_estimate = left > 0 ? std::min(left, *scene_.background.frame_count)
                                           : *scene_.background.frame_count;
    total_ = info.frame_count_estimate;
    return info;
  }

  WorkPtr read() {
    if (options_.stop.stop_requested()) return nullptr;
    const Timed timed(clocks_.read);
    auto frame = reader_.next();
    if (!frame) return nullptr;
    auto work = std::make_shared<Work>();
    work->frame = std::move(*frame);
    return work;
  }

  void move(Work& work) {
    const Timed timed(clocks_.move);
    const MotionSource::Measured measured = motion_->next(work.frame);
    work.motion = measured.motion;
    work.truth.shake = measured.shake;
    work.moment = moment_at(world_, work.frame.index, work.frame.time_s, measured.shake);
    work.ambient = ambient_->next(
        work.frame.picture, work.moment.sight, search_bounds(work.moment), work.frame.begins_shot);
  }

  void draw(Work& work) {
    if (options_.stop.stop_requested()) return;
    work.painted = painter_->draw(work.moment, work.ambient);
    clocks_.render += work.painted.render_s;
  }

  void compose(Work& work) {
    if (options_.stop.stop_requested()) return;
    const Timed timed(clocks_.composite);
    painter_->compose(work.frame.picture, work.moment, work.ambient, work.painted);
    annotation::Frame& truth = work.truth;
    truth.frame = work.frame.index;
    truth.time_s = work.frame.time_s;
    truth.damaged = work.frame.damaged;
    truth.motion_state = scene_.motion.model == "none" ? "none" : motion::name(work.motion.state);
    write_moment(world_, work.moment, work.painted, truth);
    if (scene_.output.masks) work.masks = mask_files(truth, work.painted.layer, mask_ptr(), size_);
    work.painted = {};
  }

  void write(const Work& work) {
    const Timed timed(clocks_.write);
    outputs_->write(work.frame, work.truth, work.masks);
    ++summary_.frames;
    last_time_s_ = work.frame.time_s;
    bool any = false;
    for (std::size_t i = 0; i < work.truth.intruders.size(); ++i) {
      const bool visible = work.truth.intruders[i].state == annotation::State::kVisible;
      any = any || visible;
      seen_[i] = seen_[i] || visible;
    }
    summary_.frames_visible += any ? 1 : 0;
    const motion::State state = work.motion.state;
    summary_.frames_bridged += motion::is_known(state) ? 0 : 1;
    if (work.frame.begins_shot) cuts_.push_back(work.frame.index);
    turned_away_ += state == motion::State::kTurnedAway ? 1 : 0;
    summary_.frames_damaged += work.frame.damaged ? 1 : 0;
    if (options_.progress) options_.progress({summary_.frames, total_});
  }

  void run_pipeline() {
    const int threads = options_.threads > 0 ? options_.threads : tbb::info::default_concurrency();
    const std::size_t in_flight = 2 * static_cast<std::size_t>(threads) + 2;
    // OpenGL's context belongs to one thread: the chroma-key method runs in an arena of one.
    const bool one_thread = scene_.composite.method == "chroma-key";
    tbb::task_arena arena(one_thread ? 1 : threads);
    const auto in_order = tbb::filter_mode::serial_in_order;
    const auto draw_mode = one_thread ? in_order : tbb::filter_mode::parallel;
    const auto compose_mode = painter_->is_in_order() ? in_order : draw_mode;
    arena.execute([&] {
      tbb::parallel_pipeline(
          in_flight, tbb::make_filter<void, WorkPtr>(in_order, [&](tbb::flow_control& control) {
                       WorkPtr work = read();
                       if (!work) control.stop();
                       return work;
                     }) & tbb::make_filter<WorkPtr, WorkPtr>(in_order, [&](WorkPtr work) {
                       move(*work);
                       return work;
                     }) & tbb::make_filter<WorkPtr, WorkPtr>(draw_mode, [&](WorkPtr work) {
                       draw(*work);
                       return work;
                     }) & tbb::make_filter<WorkPtr, WorkPtr>(compose_mode, [&](WorkPtr work) {
                       compose(*work);
                       return work;
                     }) & tbb::make_filter<WorkPtr, void>(in_order, [&](const WorkPtr& work) {
                       // A frame that was not painted comes after the
                       // stop.
                       if (!options_.stop.stop_requested()) write(*work);
                     }));
    });
  }

  void say_what_was_odd() const {
    const auto number = [](std::int64_t n) { return std::to_string(n); };
    if (reader_.corrupt_packets() > 0 || summary_.frames_damaged > 0)
      warn(options_.warn,
           scene_.background.video.string() + ": " + number(reader_.corrupt_packets()) +
               " corrupt packets; " + number(summary_.frames_damaged) +
               " frames are flagged damaged");
    if (reader_.ends_early())
      warn(options_.warn,
           scene_.background.video.string() + ": ends early, after " + number(summary_.frames) +
               " frames");
    if (scene_.background.frame_count && summary_.frames < *scene_.background.frame_count)
      warn(options_.warn,
           to_string(scene_.background.where) + ": frame_count is " +
               number(*scene_.background.frame_count) + ", but the video holds " +
               number(summary_.frames) + " frames from first_frame on");
    if (summary_.frames_bridged > 0)
      warn(options_.warn,
           "the camera's motion could not be measured in " + number(summary_.frames_bridged) +
               " frames; they are bridged, and truth.jsonl says which");
    if (!cuts_.empty())
      warn(options_.warn,
           fmt::format(
               "{}: the video is cut at frame {}: nothing links the camera's pose and light to "
               "the frames before",
               scene_.background.video.string(),
               fmt::join(cuts_, ", ")));
    if (turned_away_ > 0)
      warn(
          options_.warn,
          "in " + number(turned_away_) +
              " of them the camera has turned so far from the first frame that no homography holds "
              "both; expected [motion] reference = \"smoothed\", or model = \"rotation\" with the "
              "camera's lens");
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      warn_not_flyable(i);
      if (!seen_[i]) warn_never_seen(i);
    }
  }

  void warn_not_flyable(std::size_t i) const {
    const Actor& actor = world_.actors[i];
    const std::string words = words_beyond_limits(actor.aircraft, actor.path, 0, last_time_s_);
    if (words.empty()) return;
    warn(options_.warn,
         to_string(scene_.intruders[i].where) + ": intruder '" + actor.id + "': " + words);
  }

  void warn_never_seen(std::size_t i) const {
    std::string text = to_string(scene_.intruders[i].where) + ": intruder '" + world_.actors[i].id +
                       "' is never visible";
    if (const auto nearest = nearest_approach(world_, i, last_time_s_)) {
      char detail[160];
      std::snprintf(detail,
                    sizeof detail,
                    "; it comes nearest to the view's edge at %.2f s, %.1f degrees from it, at a "
                    "range of %.0f m",
                    nearest->time_s,
                    nearest->off_view_deg,
                    nearest->range_m);
      text += detail;
    } else {
      text += "; its path does not overlap the clip in time";
    }
    warn(options_.warn, text);
  }

  std::vector<Checksum> inputs() const {
    std::vector<Checksum> result;
    if (!video_sha256_.empty()) result.push_back({scene_.background.video.string(), video_sha256_});
    const auto add = [&](const fs::path& file) {
      result.push_back({file.string(), sha256_of_file(file)});
    };
    if (scene_.background.mask) add(*scene_.background.mask);
    if (camera_file_) add(*camera_file_);
    if (scene_.lens.file) add(*scene_.lens.file);
    if (scene_.camera.path_file) add(*scene_.camera.path_file);
    for (const scene::Intruder& intruder : scene_.intruders)
      if (intruder.path_file) add(*intruder.path_file);
    std::vector<fs::path> models;
    for (const Actor& actor : world_.actors)
      models.insert(models.end(), actor.type->sources.begin(), actor.type->sources.end());
    std::sort(models.begin(), models.end());
    models.erase(std::unique(models.begin(), models.end()), models.end());
    for (const fs::path& model : models) add(model);
    return result;
  }

  Options options_;
  std::optional<fs::path> camera_file_;
  StagedFolder staged_;
  video::Reader reader_;
  lens::ImageSize size_;
  std::optional<image::Mask> mask_;
  StatedScene stated_;
  scene::Scene scene_;
  World world_;
  std::unique_ptr<Painter> painter_;
  std::string video_sha256_;
  std::optional<MotionSource> motion_;
  std::optional<AmbientEstimator> ambient_;
  std::optional<Outputs> outputs_;
  std::vector<bool> seen_;
  std::int64_t turned_away_ = 0;    // frames
  std::vector<std::int64_t> cuts_;  // frames that begin a shot
  Summary summary_;
  double last_time_s_ = 0;
  mutable std::int64_t total_ = 0;
  struct {
    std::atomic<double> read = 0, move = 0, render = 0, composite = 0, write = 0;
  } clocks_;
};

}  // namespace

Summary render(const scene::Scene& scene, const fs::path& out, const Options& options) {
  std::optional<tbb::global_control> limit;
  if (options.threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism,
                  static_cast<std::size_t>(options.threads));
  const fs::path folder = out / scene.name;
  Run run(scene, folder, options);
  Summary summary = run.run();
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
                      cache_of(options));
  if (source.from_cache()) return;
  const std::int64_t total =
      scene.background.frame_count.value_or(reader.info().frame_count_estimate);
  source.measure(reader, options.stop, [&](std::int64_t done) {
    if (options.progress) options.progress({done, total});
  });
  source.store();
}

}  // namespace airtruth::sequence
