// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/parts.h"

#include <algorithm>
#include <cmath>

namespace airtruth::classical {
namespace {

// Blocks between a box and its ring, which the long element and the smoothing reach into.
constexpr int kGuardBlocks = 2;
// The ring is as wide as half of the box and not less than this.
constexpr int kLeastRingBlocks = 4;
// At the picture's border, a ring with less than this share of its blocks tells too little.
constexpr double kLeastShareOfRing = 0.6;
cv::Rect grown(const cv::Rect& blocks, int by) {
  return {blocks.x - by, blocks.y - by, blocks.width + 2 * by, blocks.height + 2 * by};
}

double sum_within(const cv::Mat& sums, const cv::Rect& blocks) {
  const cv::Point low = blocks.tl(), high = blocks.br();
  return sums.at<double>(high.y, high.x) - sums.at<double>(low.y, high.x) -
         sums.at<double>(high.y, low.x) + sums.at<double>(low.y, low.x);
}

// The blocks that a box reaches into; empty where it is not longer than the elements.
cv::Rect blocks_of(const Level& level, const Box& box_px) {
  const cv::Point low = level.sample_at({box_px.x, box_px.y});
  const cv::Point high = level.sample_at({box_px.right(), box_px.bottom()});
  const cv::Rect samples =
      cv::Rect(low, high + cv::Point(1, 1)) & cv::Rect({}, level.response.size());
  if (std::max(samples.width, samples.height) <= kLongElement) return {};
  const cv::Rect blocks(samples.tl() / kBlock,
                        (samples.br() - cv::Point(1, 1)) / kBlock + cv::Point(1, 1));
  return blocks & cv::Rect({}, level.largest.size());
}

// The noise of the picture that makes the responses in the ring; empty where too few of its blocks
// lie in the picture.
std::optional<double> noise_around(const Level& level, const cv::Rect& blocks) {
  const cv::Rect all({}, level.largest.size());
  const cv::Rect inner = grown(blocks, kGuardBlocks);
  const int width = std::max(kLeastRingBlocks, std::max(blocks.width, blocks.height) / 2);
  const cv::Rect outer = grown(inner, width);
  const cv::Rect seen_inner = inner & all, seen_outer = outer & all;
  const int seen = seen_outer.area() - seen_inner.area();
  if (seen < kLeastShareOfRing * (outer.area() - inner.area())) return std::nullopt;
  const double squares =
      sum_within(level.largest_squares, seen_outer) - sum_within(level.largest_squares, seen_inner);
  const double least = Level::quietest() / Level::kMeanResponse;
  return std::max(least, std::sqrt(squares / seen) / kLargestOfBlock);
}

}  // namespace

std::optional<Parts> parts_within(const Level& level, const Box& box_px) {
  const cv::Rect blocks = blocks_of(level, box_px);
  if (blocks.empty()) return std::nullopt;
  const auto noise = noise_around(level, blocks);
  if (!noise) return std::nullopt;
  const double response = std::sqrt(sum_within(level.largest_squares, blocks) / blocks.area());
  Parts parts;
  parts.to_noise = (response / *noise - Level::kMeanResponse) / Level::kLargestResponses;
  const double ratio = std::max(1.0, std::pow(response / (kLargestOfBlock * *noise), 2));
  parts.log_ratio = 0.5 * blocks.area() * (ratio - 1 - std::log(ratio));
  return parts;
}

std::optional<Whole> whole_of_parts(const std::vector<Level>& levels,
                                    std::size_t level,
                                    const std::vector<Box>& boxes_px) {
  std::optional<Whole> best;
  double most = 0;
  for (const Box& box : boxes_px) {
    Whole whole{box, 0};
    double log_ratio = 0;
    for (std::size_t finer = 0; finer + kPartOctaves <= level; ++finer) {
      const auto parts = parts_within(levels[finer], box);
      if (!parts) continue;
      whole.to_noise = std::max(whole.to_noise, parts->to_noise);
      log_ratio += parts->log_ratio;
    }
    if (log_ratio <= most) continue;
    most = log_ratio;
    best = whole;
  }
  return best;
}

}  // namespace airtruth::classical
