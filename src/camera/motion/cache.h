// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "camera/motion/motion.h"

namespace airtruth::motion {

// A cache of measured motion. Its key is the content that the result depends on: the video's bytes,
// the mask's bytes, the first frame, the lens, the options and the version of the estimator. The
// motion of a frame depends on earlier frames only, so the motion of a longer clip also serves a
// shorter one. Each file carries a checksum, and an incomplete or foreign file is ignored.
struct CacheKey {
  std::string video_sha256;
  std::string mask_sha256;  // "" without a mask
  std::int64_t first_frame = 0;
  std::int64_t frame_count = -1;  // -1: to the end
  std::string lens;               // the lens's parameters as text; "" for the model homography
  Options options;
  std::string file_name() const;  // a hash of everything but frame_count, with ".csv"
};

// The motion of exactly the frames of the key. Empty where the cache does not hold all of them.
std::optional<std::vector<FrameMotion>> cached(const std::filesystem::path& folder,
                                               const CacheKey& key);
// Writes the motion, unless the cache already holds more frames for this key. Throws Error where
// the folder or file cannot be written.
void store(const std::filesystem::path& folder,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion);

}  // namespace airtruth::motion
