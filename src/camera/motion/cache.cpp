// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/cache.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"

namespace airtruth::motion {
namespace {

constexpr int kEstimatorVersion = 9;  // increase it when the estimator's results change

}  // namespace

std::string CacheKey::file_name() const {
  // Smoothing is applied after the measurement, so the cached motion does not depend on it.
  return sha256_of(fmt::format("{} {} {} {} {} {} {} {} {} {} {}",
                               kEstimatorVersion,
                               video_sha256,
                               mask_sha256,
                               first_frame,
                               lens,
                               options.max_corners,
                               options.min_corner_distance_px,
                               options.forward_backward_px,
                               options.ransac_px,
                               options.min_inliers,
                               options.seed)) +
         ".csv";
}

namespace {

constexpr std::string_view kToTheEnd = " to the end";

struct Kept {
  std::vector<FrameMotion> motion;
  bool to_the_end = false;  // whether the motion covers the rest of the video
};

// The first line is the SHA-256 of the rest of the file, followed by " to the end" where it
// applies.
std::optional<Kept> kept(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  try {
    const std::string text = read_file(file);
    const auto line = text.find('\n');
    if (line == std::string::npos) return std::nullopt;
    const std::string body = text.substr(line + 1);
    const std::string hash = sha256_of(body);
    const std::string head = text.substr(0, line);
    if (head != hash && head != hash + std::string(kToTheEnd)) return std::nullopt;
    return Kept{motion_from_csv(body, file), head != hash};
  } catch (const Error&) {  // incomplete, or another kind of file: the motion is measured again
    return std::nullopt;
  }
}

}  // namespace

std::optional<std::vector<FrameMotion>> cached(const std::filesystem::path& folder,
                                               const CacheKey& key) {
  auto found = kept(folder / key.file_name());
  if (!found) return std::nullopt;
  const auto wanted = static_cast<std::size_t>(std::max<std::int64_t>(0, key.frame_count));
  if (key.frame_count < 0 ? !found->to_the_end
                          : found->motion.size() < wanted && !found->to_the_end)
    return std::nullopt;
  if (key.frame_count >= 0 && found->motion.size() > wanted) found->motion.resize(wanted);
  return std::move(found->motion);
}

void store(const std::filesystem::path& folder,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion) {
  fs::create_directories(folder);
  const fs::path file = folder / key.file_name();
  const bool to_the_end =
      key.frame_count < 0 || static_cast<std::int64_t>(motion.size()) < key.frame_count;
  if (const auto before = kept(file);
      before && (before->to_the_end || (!to_the_end && before->motion.size() >= motion.size())))
    return;
  const std::string body = csv_from_motion(motion);
  write_file(file, sha256_of(body) + (to_the_end ? std::string(kToTheEnd) : "") + "\n" + body);
}

}  // namespace airtruth::motion
