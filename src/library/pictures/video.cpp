// SPDX-License-Identifier: Apache-2.0
#include <airtruth/video.h>

#include "library/pictures/public_forms.h"
#include "picture/video/reader.h"

namespace airtruth {

VideoInfo public_info(const video::StreamInfo& info) {
  return {info.width,
          info.height,
          info.frame_rate.value(),
          info.frame_count_estimate,
          info.codec,
          info.pixel_format};
}

namespace {

video::Reader reader_from(const std::filesystem::path& video,
                          std::int64_t first_frame,
                          const Warn& warn) {
  if (first_frame < 0)
    throw Error("first_frame is " + std::to_string(first_frame) + "; expected 0 or more",
                {video.string()});
  return video::Reader(video, {.first_frame = first_frame}, warn);
}

}  // namespace

struct VideoReader::State {
  video::Reader reader;
};

VideoReader::VideoReader(const std::filesystem::path& video,
                         std::int64_t first_frame,
                         const Warn& warn)
    : state_(new State{reader_from(video, first_frame, warn)}) {}
VideoReader::~VideoReader() = default;
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;

VideoInfo VideoReader::info() const { return public_info(state_->reader.info()); }

std::optional<VideoFrame> VideoReader::next() {
  const auto frame = state_->reader.next();
  if (!frame) return std::nullopt;
  return VideoFrame{frame->index, frame->time_s, frame->damaged, public_picture(frame->picture)};
}

}  // namespace airtruth
