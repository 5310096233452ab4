// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/steps.h"

#include <algorithm>

#include "camera/motion/corners.h"

namespace airtruth::motion {
namespace {

// Both constants are chosen by judgement; docs/optimisations.md has what other methods cost.
constexpr std::size_t kFew = 64;
// The longer side of the level on which a guess ends, in samples. A search there is good to a tenth
// of a sample, and a search on the finest level reaches kPatchPx / 4 pixels.
constexpr int kMaxGuessSide = 512;

// `count` of `size` things, evenly spread.
std::size_t spread(std::size_t i, std::size_t count, std::size_t size) { return i * size / count; }

int guess_level(const Levels& levels) {
  const int coarsest = static_cast<int>(levels.size()) - 1;
  int level = std::min(1, coarsest);
  const auto side = [&](int l) {
    const cv::Mat& grey = levels[static_cast<std::size_t>(l)];
    return std::max(grey.cols, grey.rows);
  };
  while (level < coarsest && side(level) > kMaxGuessSide) ++level;
  return level;
}

}  // namespace

void Steps::take(const Levels& levels, const std::vector<Pixel>& positions) {
  cv::Mat finest = levels_.empty() ? cv::Mat() : levels_.front();
  levels.front().copyTo(finest);  // the samples of the picture will be gone
  levels_ = levels;
  levels_.front() = finest;
  corners_.clear();
  const std::size_t count = std::min(kMaxSteps, positions.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Pixel& position = positions[spread(i, count, positions.size())];
    if (const auto patch = LevelPatch::around(levels, 0, position)) corners_.push_back(*patch);
  }
}

// Follows a corner from the coarsest level to `finest`. A level on which it is not found is left
// out, but for the last.
std::optional<Step> Steps::follow(const Pixel& from, const Levels& now, int finest) const {
  Pixel way(0, 0);
  bool is_found = false;
  for (int level = static_cast<int>(levels_.size()) - 1; level >= finest; --level) {
    const auto patch = LevelPatch::around(levels_, level, from);
    const auto at = patch ? patch->find(now, patch->middle() + way) : std::nullopt;
    is_found = at.has_value();
    if (is_found) way = *at - patch->middle();
  }
  if (!is_found) return std::nullopt;
  return Step{from, from + way};
}

std::vector<Step> Steps::coarse(const Levels& now) const {
  std::vector<Step> steps;
  const int finest = guess_level(levels_);
  const std::size_t count = std::min(kFew, corners_.size());
  for (std::size_t i = 0; i < count; ++i) {
    const LevelPatch& corner = corners_[spread(i, count, corners_.size())];
    if (const auto step = follow(corner.middle(), now, finest)) steps.push_back(*step);
  }
  return steps;
}

std::vector<Step> Steps::fine(const Levels& now, const Guess& guess) const {
  std::vector<Step> steps;
  for (const LevelPatch& corner : corners_)
    if (const auto near = guess(corner.middle()))
      if (const auto to = corner.find(now, *near)) steps.push_back({corner.middle(), *to});
  return steps;
}

std::vector<Step> Steps::alone(const Levels& now,
                               const cv::Mat& allowed,
                               const Options& options) const {
  // OpenCV's positions are those of the middles of samples.
  constexpr float kHalf = 0.5f;
  std::vector<cv::Point2f> from;
  for (const LevelPatch& corner : corners_)
    from.emplace_back(static_cast<float>(corner.middle().x()) - kHalf,
                      static_cast<float>(corner.middle().y()) - kHalf);
  std::vector<cv::Point2f> to;
  const auto good = airtruth::motion::follow(
      pyramid_of(levels_.front()), pyramid_of(now.front()), allowed, from, to, false, options);
  std::vector<Step> steps;
  for (std::size_t i = 0; i < good.size(); ++i)
    if (good[i]) steps.push_back({corners_[i].middle(), Pixel(to[i].x + kHalf, to[i].y + kHalf)});
  return steps;
}

}  // namespace airtruth::motion
