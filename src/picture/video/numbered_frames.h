// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "foundation/base/log.h"
#include "picture/video/reader.h"

namespace airtruth::video {

// Access to a video's frames by number. Forward reading holds one frame. Backward reading decodes
// pieces of at most kMaxBytes anew from the start of the video.
class NumberedFrames {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{512} << 20;

  NumberedFrames(std::filesystem::path video, Warn warn)
      : video_(std::move(video)), warn_(std::move(warn)) {}

  // Returns the frame, which is valid until the next call, or nullptr beyond the end.
  const image::Picture* at(std::int64_t frame);
  // The same for a frame that a clip of this name has labels of: throws Error where the video ends
  // before, and Interrupted.
  const image::Picture& labelled(std::int64_t frame,
                                 const std::string& clip,
                                 const std::stop_token& stop);
  // Estimated number of frames; 0 where it is unknown, and before the first call of at().
  std::int64_t count_estimate() const { return reader_ ? reader_->info().frame_count_estimate : 0; }

 private:
  void open(std::int64_t first);

  std::filesystem::path video_;
  Warn warn_;
  std::optional<Reader> reader_;
  std::int64_t next_ = 0;   // frame that the reader returns next
  std::int64_t first_ = 0;  // number of the first frame in held_
  std::vector<Frame> held_;
};

}  // namespace airtruth::video
