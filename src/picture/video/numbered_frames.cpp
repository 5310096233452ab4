// SPDX-License-Identifier: Apache-2.0
#include "picture/video/numbered_frames.h"

#include <algorithm>

#include "foundation/base/error.h"

namespace airtruth::video {

void NumberedFrames::open(std::int64_t first) {
  ReaderOptions options;
  options.first_frame = first;
  options.threads = 1;
  reader_.emplace(video_, options, warn_);
  warn_ = {};  // once is enough
  next_ = first;
}

const image::Picture* NumberedFrames::at(std::int64_t frame) {
  if (frame >= first_ && frame < first_ + std::ssize(held_))
    return &held_[static_cast<std::size_t>(frame - first_)].picture;
  std::int64_t keep = 1;
  if (!reader_) {
    open(frame);
  } else if (frame < next_) {
    const StreamInfo& info = reader_->info();
    const std::size_t bytes = 3 * pixels_in(info.width, info.height);
    keep = std::max<std::int64_t>(1, static_cast<std::int64_t>(kMaxBytes / bytes));
    held_.clear();
    open(std::max<std::int64_t>(0, frame - keep + 1));
  }
  held_.clear();
  while (next_ <= frame) {
    auto read = reader_->next();
    if (!read) {
      held_.clear();
      return nullptr;
    }
    if (frame - next_ < keep) held_.push_back(std::move(*read));
    ++next_;
  }
  first_ = frame - std::ssize(held_) + 1;
  return &held_.back().picture;
}

const image::Picture& NumberedFrames::labelled(std::int64_t frame,
                                               const std::string& clip,
                                               const std::stop_token& stop) {
  if (stop.stop_requested()) throw Interrupted();
  const image::Picture* picture = at(frame);
  if (picture == nullptr)
    throw Error("ends before the labels of " + clip + " do", {video_.string()});
  return *picture;
}

}  // namespace airtruth::video
