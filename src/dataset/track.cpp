// SPDX-License-Identifier: Apache-2.0
#include "dataset/track.h"

#include <chrono>
#include <mutex>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files.h"
#include "dataset/expand.h"
#include "dataset/in_parallel.h"
#include "dataset/labelled_set.h"
#include "exchange/exchange.h"
#include "tracking/tracker.h"
#include "video/reader.h"

namespace airtruth::dataset {
namespace {

using Clock = std::chrono::steady_clock;

class Tracking {
 public:
  Tracking(const LabelledSet& set, const fs::path& out, const TrackOptions& options)
      : set_(set), folder_(out / options.tracker), options_(options) {
    for (const std::string& name : set.names())
      if (matches(options.only, name)) names_.push_back(name);
    if (names_.empty()) throw Error("no sequence fits '" + options.only + "'");
  }

  TrackSummary run() {
    tracking::make_tracker(options_.tracker, options_.seed);  // Error for what is no tracker
    fs::create_directories(folder_);
    in_parallel(
        names_.size(),
        options_.jobs,
        [this](std::size_t i) {
          const exchange::Clip clip = set_.clip(names_[i]);
          for (const exchange::Clip& one : exchange::arranged(exchange::Format::kOtb, clip))
            follow(one);
        },
        options_.progress,
        options_.stop);
    return summary_;
  }

 private:
  void follow(const exchange::Clip& clip) {
    const fs::path boxes = folder_ / (clip.name + ".txt");
    if (fs::exists(boxes)) {
      const std::lock_guard lock(mutex_);
      ++summary_.kept;
      return;
    }
    if (clip.media.empty()) throw Error(clip.name + " has no video");
    const auto tracker = tracking::make_tracker(options_.tracker, options_.seed);
    video::ReaderOptions reader_options;
    reader_options.first_frame = clip.frames.front().frame;
    reader_options.threads = 1;
    video::Reader reader(clip.media, reader_options, options_.warn);
    std::string lines;
    std::string times;
    double seconds = 0;
    for (std::size_t i = 0; i < clip.frames.size(); ++i) {
      if (options_.stop.stop_requested()) throw Interrupted();
      const auto frame = reader.next();
      if (!frame)
        throw Error("ends before the labels of " + clip.name + " do", {clip.media.string()});
      tracker->load(frame->picture);
      const auto start = Clock::now();
      Box box = clip.frames.front().labels.front().box_px;
      if (i == 0)
        tracker->init(box);
      else
        box = tracker->update().box_px;
      const double took = std::chrono::duration<double>(Clock::now() - start).count();
      if (i > 0) seconds += took;
      lines += fmt::format("{},{},{},{}\n", box.x, box.y, box.width, box.height);
      times += fmt::format("{:.6f}\n", took);
    }
    // The boxes last: they are what says that a sequence is done.
    write_file(folder_ / (clip.name + "_time.txt"), times);
    write_file(boxes, lines);
    const std::lock_guard lock(mutex_);
    ++summary_.made;
    summary_.frames += std::ssize(clip.frames) - 1;
    summary_.seconds += seconds;
  }

  const LabelledSet& set_;
  fs::path folder_;
  const TrackOptions& options_;
  std::vector<std::string> names_;
  std::mutex mutex_;
  TrackSummary summary_;
};

}  // namespace

TrackSummary track(const fs::path& set, const fs::path& out, const TrackOptions& options) {
  const LabelledSet labelled(set);
  return Tracking(labelled, out, options).run();
}

}  // namespace airtruth::dataset
