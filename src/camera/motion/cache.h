// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "camera/motion/motion.h"

namespace airtruth::motion {

// Results are cached by content: the video's bytes, the mask's, the first frame, the options and
// the version of the estimator. The motion of a frame depends on the frames before it alone, so
// what was measured of a longer clip serves a shorter one. A file that is not whole or not ours is
// ignored, never trusted.
struct CacheKey {
  std::string video_sha256;
  std::string mask_sha256;  // "" without a mask
  std::int64_t first_frame = 0;
  std::int64_t frame_count = -1;  // -1: to the end
  std::string lens;               // "" for the model homography; else words that tell lenses apart
  Options options;
  std::string file_name() const;  // a hash of all of it but frame_count, ".csv"
};

// Exactly the frames that the key asks for, or nothing.
std::optional<std::vector<FrameMotion>> cached(const std::filesystem::path& folder,
                                               const CacheKey& key);
// Keeps what was measured, unless more is kept already.
void store(const std::filesystem::path& folder,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion);

}  // namespace airtruth::motion
