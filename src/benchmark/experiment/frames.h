// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "foundation/base/log.h"
#include "picture/video/reader.h"

namespace airtruth::experiment {

// A video's frames by number, forward without holding more than one, backward in pieces of at most
// kMostBytes that are decoded anew from the start.
class Frames {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;

  Frames(std::filesystem::path video, Warn warn)
      : video_(std::move(video)), warn_(std::move(warn)) {}

  // Valid until the next call; nullptr past the end.
  const image::Picture* at(std::int64_t frame);
  // How many there are, about; 0 where that is not known, and before the first is asked for.
  std::int64_t count_estimate() const { return reader_ ? reader_->info().frame_count_estimate : 0; }

 private:
  void open(std::int64_t first);

  std::filesystem::path video_;
  Warn warn_;
  std::optional<video::Reader> reader_;
  std::int64_t next_ = 0;   // that the reader hands out
  std::int64_t first_ = 0;  // of those held
  std::vector<video::Frame> held_;
};

}  // namespace airtruth::experiment
