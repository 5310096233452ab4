// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/tracker_run.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dataset/catalogue/expand.h"
#include "dataset/labelled/labelled_set.h"
#include "dataset/sequences/layout.h"
#include "evaluation/matching/boxes.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/base/names.h"
#include "foundation/base/stopwatch.h"
#include "foundation/json/settings_record.h"
#include "foundation/run_files/run_files.h"
#include "labels/exchange/exchange.h"
#include "picture/video/numbered_frames.h"
#include "picture/video/numbered_images.h"
#include "runners/results/results_folder.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::runs {
namespace {

using Json = nlohmann::ordered_json;
using evaluation::Mark;
using evaluation::Trajectory;

// Number of frames from a failure to the next start (VOT2013).
constexpr std::int64_t kSkip = 5;

// What the runs of a sequence are made of.
struct Origin {
  fs::path truth;  // the file that states its boxes, or its folder
  Json record;
};

// One run of a tracker, with its answers and its times. A tracker that fails breaks the run off.
class Follower {
 public:
  Follower(const std::string& command, const TrackOptions& options, std::uint64_t seed)
      : command_(command), options_(options) {
    options_.seed = seed;
  }

  // Starts the tracker on a picture. `truth` is the file that states the box.
  void begin(const image::Picture& picture, const Box& box, const fs::path& truth) {
    guarded([&] {
      if (!tracker_) tracker_ = tracking::make_tracker(command_, options_);
      tracker_->load(picture);
      const Stopwatch watch;
      try {
        tracker_->init(box);
      } catch (const Error& error) {
        throw process::Failure("cannot begin: " + truth.string() + ": " + error.what());
      }
      seconds_ = watch.seconds();
    });
  }

  // Empty where the tracker lost the object or has failed.
  std::optional<Box> next(const image::Picture& picture) {
    std::optional<Box> box;
    guarded([&] {
      tracker_->load(picture);
      const Stopwatch watch;
      const tracking::Answer answer = tracker_->update();
      const double took_s = watch.seconds();
      seconds_ = answer.seconds.value_or(took_s);
      if (!answer.lost) box = answer.box_px;
      negative_boxes_ += answer.has_negative_side ? 1 : 0;
      ++answers_;
      spent_s_ += seconds_;
    });
    return box;
  }

  bool is_broken() const { return !fault_.empty(); }
  // Takes a frame down, with the duration of the call of the tracker for it; 0 without one, and
  // where it failed.
  void add(Mark mark, const std::optional<Box>& box) {
    frames_.push_back({mark, box});
    times_s_.push_back(std::exchange(seconds_, 0));
  }
  const Trajectory& frames() const { return frames_; }
  const std::vector<double>& times_s() const { return times_s_; }
  // The failure; empty where there was none.
  const std::string& fault() const { return fault_; }
  std::string log() const {
    return (tracker_ ? tracker_->log() : "") +
           (is_broken() ? std::string(results::kBrokenOff) + fault_ + "\n" : "");
  }
  std::int64_t answers() const { return answers_; }
  // Of the answers without a box those with a width or height below 0.
  std::int64_t negative_boxes() const { return negative_boxes_; }
  // Sum of the durations of all answers, in seconds.
  double spent_s() const { return spent_s_; }

 private:
  void guarded(const auto& work) {
    try {
      work();
    } catch (const process::Failure& error) {
      fault_ = error.what();
    }
  }

  std::string command_;
  tracking::TrackerOptions options_;
  std::unique_ptr<tracking::Tracker> tracker_;
  double seconds_ = 0;  // of the last call, until its frame is taken down
  Trajectory frames_;
  std::vector<double> times_s_;
  std::string fault_;
  std::int64_t answers_ = 0;
  std::int64_t negative_boxes_ = 0;
  double spent_s_ = 0;
};

class TrackerRun {
 public:
  TrackerRun(const fs::path& out, const TrackOptions& options) : options_(options) {
    require_utf8(options.tracker);
    try {
      const tracking::TrackerName name = tracking::named(options.tracker, options);
      command_ = name.command;
      summary_.folder = out / name.name;
      // Error for what is no tracker, before anything is made.
      if (!name.was_started) tracking::make_tracker(command_, options);
    } catch (const process::Failure& error) {
      throw Error("the tracker '" + options.tracker + "' " + error.what());
    }
  }

  // Results of one folder are of one tracker and one seed: Error where it holds others. Is the
  // folder there?
  bool check_folder() const { return is_record_of(summary_.folder / "tracker.json", own_record()); }

  TrackSummary over(const labelled::LabelledSet& set) {
    std::vector<std::string> names;
    for (const std::string& name : set.names())
      if (matches(options_.only, name)) names.push_back(name);
    if (names.empty()) throw Error("no sequence fits '" + options_.only + "'");
    expect_clear(set, names);
    open_folder();
    in_parallel(names.size(), options_, [&](std::size_t i) {
      const fs::path folder = set.folder(names[i]);
      const Origin origin{set.is_imported(names[i]) ? folder / sequences::kLabels : folder,
                          {{results::kSourceSha256, set.sha256_of(names[i])}}};
      for (const exchange::Clip& clip :
           exchange::arranged(exchange::Format::kOtb, set.clip(names[i])))
        follow(clip, origin);
    });
    return summary_;
  }

  TrackSummary over(const fs::path& video, const Box& init, std::int64_t first_frame) {
    const std::string name = video::clip_name(video);
    const fs::path source = absolute_path(video);
    require_utf8(source);
    const fs::path file =
        results::trajectory_file(summary_.folder, results::Protocol::kOnePass, name, 0);
    video::NumberedFrames frames(video, options_.warn);
    Follower follower(command_, options_, options_.seed);
    const image::Picture* picture = frames.at(first_frame);
    check(picture != nullptr, "the reader refuses a first frame past the end");
    const std::int64_t total = frames.count_estimate();
    expect_inside(init, *picture);
    setup::SharedInputs inputs;
    const Json origin = {{"source", source.string()},
                         {results::kSourceSha256, setup::sha256_of_video(video, inputs)},
                         {"first_frame", first_frame}};
    open_folder();
    if (fs::exists(file)) expect_begun_at(init, file);
    if (is_there(file, results::Protocol::kOnePass, origin)) return summary_;
    follower.begin(*picture, init, "--init");
    follower.add(Mark::kAnswer, init);
    for (std::int64_t i = first_frame + 1;
         !follower.is_broken() && (picture = frames.at(i)) != nullptr;
         ++i) {
      if (options_.stop.stop_requested()) throw Interrupted();
      const auto box = follower.next(*picture);
      follower.add(Mark::kAnswer, box);
      if (options_.progress) options_.progress(i - first_frame, std::max(i, total) - first_frame);
    }
    write(file, results::Protocol::kOnePass, name, follower, origin);
    return summary_;
  }

 private:
  // Throws Error where two runs would have one name, and where the folder holds others' runs.
  void expect_clear(const labelled::LabelledSet& set, const std::vector<std::string>& names) const {
    exchange::ArrangedNames runs;
    for (const std::string& name : names) {
      if (options_.stop.stop_requested()) throw Interrupted();
      const auto clips = exchange::arranged(exchange::Format::kOtb, set.clip(name));
      exchange::add_names(runs, name, clips);
      for (const exchange::Clip& clip : clips) expect_no_others(clip);
    }
    results::expect_own_files(runs);
  }

  // Evaluation takes every run of a protocol: those of another step, too.
  void expect_no_others(const exchange::Clip& clip) const {
    if (options_.protocol == results::Protocol::kOnePass) return;
    std::set<fs::path> mine;
    const auto add = [&](std::int64_t number) {
      mine.insert(results::trajectory_file(summary_.folder, options_.protocol, clip.name, number));
    };
    if (options_.protocol == results::Protocol::kRestart)
      for (int r = 1; r <= options_.repetitions; ++r) add(r);
    else
      for (const auto& anchor : anchors_in(clip)) add(anchor.frame);
    const fs::path folder = summary_.folder / enum_name(options_.protocol) / clip.name;
    for (const fs::path& file : files_with(folder, ".txt"))
      if (!mine.contains(file))
        throw Error(
            "is a run that this call does not make (another --anchor-step, more --repetitions or "
            "another truth), and evaluation takes it; give another --out or remove the folder",
            {file.string()});
  }

  std::vector<evaluation::Anchor> anchors_in(const exchange::Clip& clip) const {
    return evaluation::anchors_of(results::vot_truth(clip), options_.anchor_step);
  }

  static void expect_inside(const Box& box, const image::Picture& picture) {
    if (!intersection(pixels_of(box), {0, 0, picture.width, picture.height}))
      throw Error(fmt::format("--init {},{},{},{} lies outside the picture of {}x{}",
                              box.x,
                              box.y,
                              box.width,
                              box.height,
                              picture.width,
                              picture.height));
  }

  static void expect_begun_at(const Box& init, const fs::path& file) {
    const std::string first = results::text_of(Trajectory{{Mark::kAnswer, init}});
    if (!read_file(file).starts_with(first))
      throw Error("holds a run from another box; give another --out or remove it", {file.string()});
  }

  Json own_record() const { return {{"tracker", options_.tracker}, {"seed", options_.seed}}; }

  void open_folder() {
    check_folder();
    make_folders(summary_.folder);
    lock_.emplace(summary_.folder, summary_.folder, options_.warn);
    check_folder();
  }

  // Before the first result: a call that makes none must not refuse the next for its settings.
  void write_record() {
    const std::lock_guard lock(mutex_);
    if (check_folder()) return;
    Json record = own_record();
    record["format"] = "airtruth results 1";
    record["version"] = kVersion;
    record["seconds"] =
        "of each answer: the tracker's own work, from the picture in the form that it takes; for "
        "TraX from the request's last byte to the answer, with its reading of the picture";
    write_file(summary_.folder / "tracker.json", record.dump(1) + "\n");
  }

  // Counts a run that is there, with its times: a process that was killed may have left the one
  // without the other. Throws Error where it is of another origin.
  bool is_there(const fs::path& file, results::Protocol protocol, const Json& origin) {
    if (!fs::exists(file)) return false;
    refuse_other(results::run_record(file), origin);
    if (!fs::exists(results::times_file(file, protocol))) return false;
    const std::lock_guard lock(mutex_);
    ++summary_.kept;
    return true;
  }

  void write(const fs::path& file,
             results::Protocol protocol,
             const std::string& name,
             const Follower& follower,
             const Json& origin) {
    write_record();
    results::write_log(summary_.folder, file.stem().string(), follower.log());
    if (follower.is_broken()) {
      const std::lock_guard lock(mutex_);
      ++summary_.broken;
      return airtruth::warn(
          options_.warn,
          fmt::format("{} on {}: the tracker {}", options_.tracker, name, follower.fault()));
    }
    fs::create_directories(file.parent_path());
    const fs::path times = results::times_file(file, protocol);
    const fs::path record = results::run_record(file);
    RunFiles files;
    files.writes(record, true).writes(times, true).writes(file, true);
    files.begin();
    files.write(record, [&](const fs::path& at) { write_file(at, origin.dump(1) + "\n"); });
    files.write(times,
                [&](const fs::path& at) { write_file(at, results::text_of(follower.times_s())); });
    files.write(file,
                [&](const fs::path& at) { write_file(at, results::text_of(follower.frames())); });
    files.commit();
    const std::lock_guard lock(mutex_);
    ++summary_.made;
    summary_.frames += follower.answers();
    summary_.seconds += follower.spent_s();
    if (follower.negative_boxes() > 0 && !std::exchange(negative_is_told_, true))
      airtruth::warn(options_.warn,
                     fmt::format("{} on {}: {} boxes have a width or height below 0, and count as "
                                 "no answer, here and in other runs",
                                 options_.tracker,
                                 name,
                                 follower.negative_boxes()));
  }

  void follow(const exchange::Clip& clip, const Origin& origin) {
    if (clip.media.empty()) throw Error(clip.name + " has no video");
    video::NumberedFrames frames(clip.media, options_.warn);
    switch (options_.protocol) {
      case results::Protocol::kOnePass:
        return follow_from(clip, frames, {0, false}, results::Protocol::kOnePass, origin);
      case results::Protocol::kRestart:
        for (int r = 1; r <= options_.repetitions; ++r)
          follow_with_restarts(clip, frames, r, origin);
        return;
      case results::Protocol::kMultiStart:
        for (const evaluation::Anchor& anchor : anchors_in(clip))
          follow_from(clip, frames, anchor, results::Protocol::kMultiStart, origin);
        return;
    }
  }

  const image::Picture& picture_of(video::NumberedFrames& frames,
                                   const exchange::Clip& clip,
                                   std::size_t i) const {
    return frames.labelled(clip.frames[i].frame, clip.name, options_.stop);
  }

  // Runs from an anchor to the clip's end, or backward to its beginning.
  void follow_from(const exchange::Clip& clip,
                   video::NumberedFrames& frames,
                   const evaluation::Anchor& anchor,
                   results::Protocol protocol,
                   const Origin& origin) {
    const fs::path file =
        results::trajectory_file(summary_.folder, protocol, clip.name, anchor.frame);
    if (is_there(file, protocol, origin.record)) return;
    Follower follower(command_, options_, options_.seed);
    const std::int64_t way = anchor.is_backward ? -1 : 1;
    for (std::int64_t i = anchor.frame;
         i >= 0 && i < std::ssize(clip.frames) && !follower.is_broken();
         i += way) {
      const auto at = static_cast<std::size_t>(i);
      if (i == anchor.frame) {
        const Box box = *results::box_of(clip.frames[at]);
        follower.begin(picture_of(frames, clip, at), box, origin.truth);
        const bool marks = protocol == results::Protocol::kMultiStart;
        follower.add(marks ? Mark::kBegun : Mark::kAnswer, box);
      } else {
        const auto box = follower.next(picture_of(frames, clip, at));
        follower.add(Mark::kAnswer, box);
      }
    }
    write(file, protocol, clip.name, follower, origin.record);
  }

  void follow_with_restarts(const exchange::Clip& clip,
                            video::NumberedFrames& frames,
                            int repetition,
                            const Origin& origin) {
    const fs::path file = results::trajectory_file(
        summary_.folder, results::Protocol::kRestart, clip.name, repetition);
    if (is_there(file, results::Protocol::kRestart, origin.record)) return;
    Follower follower(
        command_, options_, options_.seed + static_cast<std::uint64_t>(repetition) - 1);
    bool is_begun = false;
    std::int64_t skip = 0;
    for (std::size_t i = 0; i < clip.frames.size() && !follower.is_broken(); ++i) {
      const auto truth = results::box_of(clip.frames[i]);
      if (!is_begun && (skip > 0 || !truth)) {
        skip -= skip > 0 ? 1 : 0;
        follower.add(Mark::kUnknown, {});
        continue;
      }
      if (!is_begun) {
        follower.begin(picture_of(frames, clip, i), *truth, origin.truth);
        follower.add(Mark::kBegun, {});
        is_begun = true;
        continue;
      }
      const auto box = follower.next(picture_of(frames, clip, i));
      const evaluation::VotFrame answer{Mark::kAnswer, box};
      const bool failed =
          truth && evaluation::frame_overlap(answer, *truth, clip.width, clip.height) <= 0;
      follower.add(failed ? Mark::kFailed : Mark::kAnswer, failed ? std::nullopt : box);
      is_begun = !failed;
      if (failed) skip = kSkip - 1;
    }
    write(file, results::Protocol::kRestart, clip.name, follower, origin.record);
  }

  const TrackOptions& options_;
  std::string command_;
  std::mutex mutex_;
  TrackSummary summary_;
  bool negative_is_told_ = false;
  std::optional<RunLock> lock_;
};

}  // namespace

void check_track(const fs::path& out, const TrackOptions& options) {
  TrackerRun(out, options).check_folder();
}

TrackSummary track(const fs::path& set, const fs::path& out, const TrackOptions& options) {
  const labelled::LabelledSet labelled(set);
  return TrackerRun(out, options).over(labelled);
}

TrackSummary track_video(const fs::path& video,
                         const Box& init,
                         std::int64_t first_frame,
                         const fs::path& out,
                         const TrackOptions& options) {
  return TrackerRun(out, options).over(video, init, first_frame);
}

}  // namespace airtruth::runs
