// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/level_patch.h"

#include <algorithm>
#include <cmath>

namespace airtruth::motion {
namespace {

// A patch is found where what remains is at most this share of the patch's contrast.
constexpr double kMaxUnlikeness = 0.7;

double scale_of(int level) { return static_cast<double>(1 << level); }

}  // namespace

std::optional<LevelPatch> LevelPatch::around(const Levels& levels,
                                             int level,
                                             const Pixel& position) {
  const cv::Mat& grey = levels[static_cast<std::size_t>(level)];
  const auto first_of = [&](double p) {
    return static_cast<int>(std::lround(p / scale_of(level))) - kPatchPx / 2;
  };
  cv::Point first(first_of(position.x()), first_of(position.y()));
  if (level > 0) {
    first.x = std::max(1, std::min(first.x, grey.cols - kPatchPx - 1));
    first.y = std::max(1, std::min(first.y, grey.rows - kPatchPx - 1));
  }
  const auto patch = Patch::at(grey, first.x, first.y);
  if (!patch) return std::nullopt;
  return LevelPatch(level, first, *patch);
}

Pixel LevelPatch::middle() const {
  return scale_of(level_) * Pixel(first_.x + kPatchPx / 2, first_.y + kPatchPx / 2);
}

std::optional<Pixel> LevelPatch::find(const Levels& levels, const Pixel& guess) const {
  const Pixel half(kPatchPx / 2, kPatchPx / 2);
  const Pixel first = guess / scale_of(level_) - half;
  const auto found = patch_.find(levels[static_cast<std::size_t>(level_)], first.x(), first.y());
  if (!found || found->unlikeness > kMaxUnlikeness) return std::nullopt;
  return scale_of(level_) * (Pixel(found->x, found->y) + half);
}

}  // namespace airtruth::motion
