// SPDX-License-Identifier: Apache-2.0
#include "runners/runs/follower.h"

#include <chrono>

namespace airtruth::runs {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

tracking::TrackerOptions tracker_options(const TrackOptions& options, std::uint64_t seed) {
  return {
      .seed = seed, .start_s = options.start_s, .answer_s = options.answer_s, .stop = options.stop};
}

bool Follower::guarded(const auto& work) {
  try {
    work();
    return true;
  } catch (const process::Failure& error) {
    fault_ = error.what();
    seconds_ = 0;
    if (tracker_) log_ += tracker_->log();
    log_ += "airtruth: the tracker " + fault_ + "\n";
    tracker_.reset();
    return false;
  }
}

bool Follower::begin(const image::Picture& picture, const Box& box) {
  return guarded([&] {
    if (!tracker_) tracker_ = tracking::make_tracker(command_, options_);
    tracker_->load(picture);
    const auto start = Clock::now();
    tracker_->init(box);
    seconds_ = seconds_since(start);
  });
}

std::optional<Box> Follower::next(const image::Picture& picture) {
  std::optional<Box> box;
  seconds_ = 0;
  if (!tracker_) return box;
  guarded([&] {
    tracker_->load(picture);
    const auto start = Clock::now();
    const tracking::Answer answer = tracker_->update();
    const double took_s = seconds_since(start);
    seconds_ = answer.seconds.value_or(took_s);
    if (!answer.lost) box = answer.box_px;
    ++answers_;
    spent_s_ += seconds_;
  });
  return box;
}

}  // namespace airtruth::runs
