// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "runners/runs/tracker_run.h"
#include "runners/tracking/tracker.h"

// One run of a tracker, with its answers and its times.
namespace airtruth::runs {

tracking::TrackerOptions tracker_options(const TrackOptions& options, std::uint64_t seed);

// A failed tracker gives no more answers until begin() starts it anew.
class Follower {
 public:
  Follower(const std::string& command, const TrackOptions& options, std::uint64_t seed)
      : command_(command), options_(tracker_options(options, seed)) {}

  // Starts the tracker on a picture. Returns false where it failed.
  bool begin(const image::Picture& picture, const Box& box);

  // Empty where the tracker lost the object or has failed.
  std::optional<Box> next(const image::Picture& picture);

  bool is_broken() const { return !tracker_; }
  // Duration of the last call of the tracker; 0 where it failed.
  double seconds() const { return seconds_; }
  // The last failure; empty where there was none.
  const std::string& fault() const { return fault_; }
  std::string log() const { return log_ + (tracker_ ? tracker_->log() : ""); }
  std::int64_t answers() const { return answers_; }
  // Sum of the durations of all answers, in seconds.
  double spent_s() const { return spent_s_; }

 private:
  bool guarded(const auto& work);

  std::string command_;
  tracking::TrackerOptions options_;
  std::unique_ptr<tracking::Tracker> tracker_;
  double seconds_ = 0;
  std::string fault_;
  std::string log_;
  std::int64_t answers_ = 0;
  double spent_s_ = 0;
};

}  // namespace airtruth::runs
