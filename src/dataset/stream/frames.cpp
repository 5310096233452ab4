// SPDX-License-Identifier: Apache-2.0
#include "dataset/stream/frames.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "dataset/stream/plan.h"
#include "foundation/base/error.h"
#include "foundation/image/cuts.h"

namespace airtruth::stream {
namespace {

// What a decoder keeps beside the frames that it has given: up to 16 that later frames refer to
// (ITU-T H.264, A.3.1), and those that wait for their turn.
constexpr std::size_t kFramesOfDecoder = 20;
// Runs whose files are open: those of the lanes that are used now, and as many that others may be
// behind or ahead with.
constexpr std::size_t kMostOpen = 2 * kLanes;

// Counts frames and times from the first one, and finds its cuts, as a reader of these frames does.
void count_from_first(std::vector<video::Frame>& frames, const video::Rational& time_base) {
  image::Differences difference;
  std::vector<double> differences;
  const std::int64_t first_pts = frames.front().pts;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].index = static_cast<std::int64_t>(k);
    frames[k].time_s = static_cast<double>(frames[k].pts - first_pts) * time_base.value();
    if (frames.size() > 1)
      if (const auto d = difference.add(frames[k].picture)) differences.push_back(*d);
  }
  for (std::size_t k = 1; k < frames.size(); ++k)
    frames[k].begins_shot = !frames[k].damaged && image::is_cut(differences, k - 1);
}

}  // namespace

video::Frame copy_of(const video::Frame& frame) {
  return {frame.index,
          frame.pts,
          frame.time_s,
          frame.begins_shot,
          frame.damaged,
          frame.quantiser,
          frame.picture.clone()};
}

std::shared_ptr<const Shot> Frames::at(const Wanted& wanted) {
  const std::shared_ptr<Run> run = run_of(wanted.run);
  std::shared_ptr<const Shot> shot;
  {
    const std::lock_guard lock(run->reading);
    if (run->shot_frame != wanted.first_frame) {
      run->shot = read(*run, wanted);
      run->shot_frame = wanted.first_frame;
    }
    shot = run->shot;
  }
  keep_within_bounds(
      *run, shot->frames.front().picture.bytes() * (kFramesOfDecoder + shot->frames.size()));
  return shot;
}

std::shared_ptr<const Shot> Frames::read(Run& run, const Wanted& wanted) {
  const auto count = static_cast<std::size_t>(wanted.count);
  const std::int64_t first_kept = run.next_frame - std::ssize(run.kept);
  const bool goes_on = run.reader && wanted.first_frame >= first_kept &&
                       wanted.first_frame <= run.next_frame + kRunFrames;
  if (!goes_on) {
    run.kept.clear();
    run.reader.emplace(wanted.open(wanted.first_frame));
    run.time_base = run.reader->info().time_base;
    run.next_frame = wanted.first_frame;
  }
  while (run.next_frame < wanted.first_frame + wanted.count) {
    auto frame = run.reader->next();
    if (!frame) {
      const std::int64_t end = run.next_frame;
      run.reader.reset();
      throw Error(fmt::format("ends after {} frames, and states more", end),
                  {wanted.video.string()});
    }
    run.kept.push_back(std::move(*frame));
    ++run.next_frame;
    if (run.kept.size() > count) run.kept.pop_front();
  }
  auto shot = std::make_shared<Shot>();
  const auto skipped =
      static_cast<std::size_t>(wanted.first_frame - run.next_frame) + run.kept.size();
  for (std::size_t k = 0; k < count; ++k) shot->frames.push_back(copy_of(run.kept[skipped + k]));
  count_from_first(shot->frames, run.time_base);
  shot->motion = wanted.measure(shot->frames);
  return shot;
}

std::shared_ptr<Frames::Run> Frames::run_of(std::int64_t number) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Run>& run = runs_[number];
  if (!run) run = std::make_shared<Run>();
  run->last_use = ++uses_;
  return run;
}

// Closes the runs whose last use is longest ago. A thread that still uses one keeps it until then.
void Frames::keep_within_bounds(const Run& used, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  std::size_t all = 0;
  for (auto& [number, run] : runs_) {
    if (run.get() == &used) run->bytes = bytes;
    all += run->bytes;
  }
  while (runs_.size() > 1 && (all > most_bytes_ || runs_.size() > kMostOpen)) {
    const auto oldest = std::ranges::min_element(
        runs_, {}, [](const auto& entry) { return entry.second->last_use; });
    all -= oldest->second->bytes;
    runs_.erase(oldest);
  }
}

}  // namespace airtruth::stream
