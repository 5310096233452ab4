// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "picture/video/reader.h"
#include "sequence/setup/motion_source.h"

namespace airtruth::stream {

// Consecutive frames of a background, as a reader from the first of them on hands them out, and how
// the camera moves in them.
struct Shot {
  std::vector<video::Frame> frames;
  std::vector<setup::MotionSource::Measured> motion;
};

// With a picture of its own.
video::Frame copy_of(const video::Frame& frame);

// Decoded frames by run and number, in bounded memory. Frames are decoded on from those that the
// run had before; any others from the key frame before them. Threads may use it at the same time.
class Frames {
 public:
  // `most_bytes`: of the decoded frames of all runs; one run is kept whatever it takes.
  explicit Frames(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  struct Wanted {
    std::filesystem::path video;  // for messages
    std::int64_t run = 0;
    std::int64_t first_frame = 0;  // in the video
    std::int64_t count = 1;
    // A reader of the run's video from a frame on.
    std::function<video::Reader(std::int64_t)> open;
    // How the camera moves in the frames; called once for each shot.
    std::function<std::vector<setup::MotionSource::Measured>(const std::vector<video::Frame>&)>
        measure;
  };
  // Throws Error where the video ends before the last of the frames, and as video::Reader does.
  std::shared_ptr<const Shot> at(const Wanted& wanted);

 private:
  struct Run {
    std::mutex reading;
    std::optional<video::Reader> reader;
    video::Rational time_base;
    std::int64_t next_frame = 0;    // that the reader gives
    std::deque<video::Frame> kept;  // the last ones of the reader
    std::int64_t shot_frame = -1;   // of `shot`
    std::shared_ptr<const Shot> shot;
    // Guarded by Frames::mutex_.
    std::size_t bytes = 0;
    std::uint64_t last_use = 0;
  };

  std::shared_ptr<Run> run_of(std::int64_t number);
  static std::shared_ptr<const Shot> read(Run& run, const Wanted& wanted);
  void keep_within_bounds(const Run& used, std::size_t bytes);

  const std::size_t most_bytes_;
  std::mutex mutex_;
  std::map<std::int64_t, std::shared_ptr<Run>> runs_;
  std::uint64_t uses_ = 0;
};

}  // namespace airtruth::stream
