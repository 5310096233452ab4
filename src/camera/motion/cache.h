// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera/motion/motion.h"
#include "foundation/disk_cache/disk_cache.h"

namespace airtruth::motion {

// Measured motion in a cache. The motion of a frame depends on earlier frames only, so the motion
// of a longer clip also serves a shorter one.
struct CacheKey {
  std::string video_sha256;
  std::string mask_sha256;  // "" without a mask
  std::int64_t first_frame = 0;
  std::int64_t frame_count = -1;  // -1: to the end
  std::string lens;               // the lens's parameters as text; "" for the model homography
  Options options;
  // Everything but frame_count.
  disk_cache::Key entry() const;
};

// The motion of exactly the frames of the key. Empty where the cache does not hold all of them.
std::optional<std::vector<FrameMotion>> cached(const disk_cache::Cache& cache, const CacheKey& key);
// Keeps the motion, unless the cache already holds more frames for this key.
void store(const disk_cache::Cache& cache,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion);

}  // namespace airtruth::motion
