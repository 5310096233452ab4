// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "image/layer.h"
#include "motion/cache.h"
#include "motion/motion.h"
#include "scene/scene.h"
#include "video/reader.h"

// Where a frame's homography comes from: the cache, a pass made before, or an estimator that runs
// along.
namespace airtruth::sequence {

namespace fs = std::filesystem;

// SHA-256 of a video file's bytes, or over the files of a folder of images; "" for a pattern of
// numbered images.
std::string sha256_of_video(const fs::path& video);

class MotionSource {
 public:
  // model "none": identity for every frame.
  MotionSource(const scene::Scene& scene,
               const std::string& video_sha256,
               const image::Mask* mask,
               const fs::path& cache);  // empty: none

  // True when frames must be seen once before the first homography is known (reference "smoothed",
  // not cached).
  bool needs_pass() const { return smoothed_ && !ready_; }
  // That pass, over all the frames of a reader; `seen` after each. Throws Interrupted on stop.
  void measure(video::Reader& reader,
               const std::stop_token& stop,
               const std::function<void(std::int64_t)>& seen);

  // Frames in order.
  motion::FrameMotion next(const video::Frame& frame);
  // After the last frame: keeps what was measured for the next run. A cache that cannot be written
  // is no error.
  void store() const;
  bool from_cache() const { return from_cache_; }

 private:
  void set_pass(std::vector<motion::FrameMotion> against_first);
  motion::FrameMotion measured(const video::Frame& frame);

  bool none_ = false;
  bool smoothed_ = false;
  bool ready_ = false;  // all_ holds every frame
  bool from_cache_ = false;
  fs::path cache_;
  motion::Options options_;
  motion::CacheKey key_;
  const image::Mask* mask_;
  std::optional<motion::Estimator> estimator_;
  std::vector<motion::FrameMotion> against_first_;
  std::vector<motion::FrameMotion> all_;
};

// Motion of a whole clip against its first frame; `seen` after each frame. Throws Interrupted on
// stop.
std::vector<motion::FrameMotion> measure_motion(video::Reader& reader,
                                                const motion::Options& options,
                                                const image::Mask* mask,
                                                std::stop_token stop,
                                                const std::function<void(std::int64_t)>& seen);

}  // namespace airtruth::sequence
