// SPDX-License-Identifier: Apache-2.0
#include "motion/cache.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/files.h"

namespace airtruth::motion {
namespace {

constexpr int kEstimatorVersion = 3;  // raise it whenever the estimator's numbers change

}  // namespace

std::string CacheKey::file_name() const {
  // Smoothing comes after measuring and is no part of what is kept.
  return sha256_of(fmt::format("{} {} {} {} {} {} {} {} {} {} {}",
                               kEstimatorVersion,
                               video_sha256,
                               mask_sha256,
                               first_frame,
                               frame_count,
                               options.max_corners,
                               options.min_corner_distance_px,
                               options.forward_backward_px,
                               options.ransac_px,
                               options.min_inliers,
                               options.seed)) +
         ".csv";
}

std::optional<std::vector<FrameMotion>> cached(const std::filesystem::path& folder,
                                               const CacheKey& key) {
  const fs::path file = folder / key.file_name();
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  try {
    const std::string text = read_file(file);
    const auto line = text.find('\n');
    if (line == std::string::npos || text.substr(0, line) != sha256_of(text.substr(line + 1)))
      return std::nullopt;
    return motion_from_csv(text.substr(line + 1), file);
  } catch (const Error&) {  // not whole, or not ours: measured anew
    return std::nullopt;
  }
}

void store(const std::filesystem::path& folder,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion) {
  fs::create_directories(folder);
  const std::string body = csv_from_motion(motion);
  write_file(folder / key.file_name(), sha256_of(body) + "\n" + body);
}

}  // namespace airtruth::motion
