// SPDX-License-Identifier: Apache-2.0
#include "sequence/motion_source.h"

#include <algorithm>
#include <exception>

#include "base/error.h"
#include "base/files.h"

namespace airtruth::sequence {

std::string sha256_of_video(const fs::path& video) {
  if (fs::is_regular_file(video)) return sha256_of_file(video);
  if (!fs::is_directory(video)) return "";
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(video))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string all;
  for (const fs::path& file : files)
    all += file.filename().string() + ' ' + sha256_of_file(file) + '\n';
  return sha256_of(all);
}

MotionSource::MotionSource(const scene::Scene& scene,
                           const std::string& video_sha256,
                           const image::Mask* mask,
                           const fs::path& cache)
    : none_(scene.motion.model == "none"),
      smoothed_(scene.motion.model != "none" && scene.motion.reference == "smoothed"),
      cache_(video_sha256.empty() || none_ ? fs::path() : cache),
      mask_(mask) {
  options_.seed = scene.seed;
  options_.smoothing_s = scene.motion.smoothing_s;
  key_.video_sha256 = video_sha256;
  if (scene.background.mask) key_.mask_sha256 = sha256_of_file(*scene.background.mask);
  key_.first_frame = scene.background.first_frame;
  key_.frame_count = scene.background.frame_count.value_or(-1);
  key_.options = options_;
  if (cache_.empty()) return;
  if (auto found = motion::cached(cache_, key_)) {
    from_cache_ = true;
    set_pass(std::move(*found));
  }
}

void MotionSource::set_pass(std::vector<motion::FrameMotion> against_first) {
  against_first_ = std::move(against_first);
  all_ = smoothed_ ? motion::smoothed(against_first_, options_) : against_first_;
  ready_ = true;
}

void MotionSource::measure(video::Reader& reader,
                           const std::stop_token& stop,
                           const std::function<void(std::int64_t)>& seen) {
  set_pass(measure_motion(reader, options_, mask_, stop, seen));
}

motion::FrameMotion MotionSource::next(const video::Frame& frame) {
  if (none_) {
    motion::FrameMotion still;
    still.frame = frame.index;
    still.time_s = frame.time_s;
    return still;
  }
  if (!ready_) return measured(frame);
  check(frame.index < static_cast<std::int64_t>(all_.size()), "motion is known for every frame");
  return all_[static_cast<std::size_t>(frame.index)];
}

motion::FrameMotion MotionSource::measured(const video::Frame& frame) {
  if (!estimator_) estimator_.emplace(frame.picture.width, frame.picture.height, options_, mask_);
  motion::FrameMotion motion = estimator_->next(frame.picture, frame.time_s, frame.damaged);
  motion.frame = frame.index;
  against_first_.push_back(motion);
  return motion;
}

void MotionSource::store() const {
  if (cache_.empty() || from_cache_) return;
  try {
    motion::store(cache_, key_, against_first_);
  } catch (const std::exception&) {  // read-only home, full disk: the next run measures again
  }
}

std::vector<motion::FrameMotion> measure_motion(video::Reader& reader,
                                                const motion::Options& options,
                                                const image::Mask* mask,
                                                std::stop_token stop,
                                                const std::function<void(std::int64_t)>& seen) {
  motion::Estimator estimator(reader.info().width, reader.info().height, options, mask);
  std::vector<motion::FrameMotion> result;
  while (const auto frame = reader.next()) {
    if (stop.stop_requested()) throw Interrupted();
    result.push_back(estimator.next(frame->picture, frame->time_s, frame->damaged));
    result.back().frame = frame->index;
    if (seen) seen(static_cast<std::int64_t>(result.size()));
  }
  return result;
}

}  // namespace airtruth::sequence
