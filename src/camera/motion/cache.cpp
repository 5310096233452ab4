// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/cache.h"

#include <algorithm>
#include <string_view>

#include "foundation/base/error.h"

namespace airtruth::motion {
namespace {

// The first line of an entry, before the motion as CSV.
constexpr std::string_view kToTheEnd = "to the end\n";  // of the video
constexpr std::string_view kUntilThere = "until there\n";

struct Kept {
  std::vector<FrameMotion> motion;
  bool to_the_end = false;
};

Kept kept_from(const std::string& body) {
  const bool to_the_end = body.starts_with(kToTheEnd);
  if (!to_the_end && !body.starts_with(kUntilThere)) throw Error("is no motion");
  return {motion_from_csv(body.substr(body.find('\n') + 1), {}), to_the_end};
}

}  // namespace

disk_cache::Key CacheKey::entry() const {
  // Smoothing is applied after the measurement, so the measured motion does not depend on it.
  return disk_cache::Key("motion")
      .add(video_sha256)
      .add(mask_sha256)
      .add(first_frame)
      .add(lens)
      .add(options.max_corners)
      .add(options.min_corner_distance_px)
      .add(options.forward_backward_px)
      .add(options.ransac_px)
      .add(options.min_inliers)
      .add(options.seed);
}

std::optional<std::vector<FrameMotion>> cached(const disk_cache::Cache& cache,
                                               const CacheKey& key) {
  auto found = cache.find(key.entry(), kept_from);
  if (!found) return std::nullopt;
  const auto wanted = static_cast<std::size_t>(std::max<std::int64_t>(0, key.frame_count));
  if (key.frame_count < 0 ? !found->to_the_end
                          : found->motion.size() < wanted && !found->to_the_end)
    return std::nullopt;
  if (key.frame_count >= 0 && found->motion.size() > wanted) found->motion.resize(wanted);
  return std::move(found->motion);
}

void store(const disk_cache::Cache& cache,
           const CacheKey& key,
           const std::vector<FrameMotion>& motion) {
  const bool to_the_end =
      key.frame_count < 0 || static_cast<std::int64_t>(motion.size()) < key.frame_count;
  const auto before = cache.find(key.entry(), kept_from);
  if (before && (before->to_the_end || (!to_the_end && before->motion.size() >= motion.size())))
    return;
  cache.keep(key.entry(),
             std::string(to_the_end ? kToTheEnd : kUntilThere) + csv_from_motion(motion));
}

}  // namespace airtruth::motion
