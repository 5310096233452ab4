// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/scale_space.h"

#include <cmath>

#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

namespace airtruth::classical {
namespace {

// Where a constant of this file states no origin, it is a choice; docs/detection.md has the result.

// Least side of a level, in samples: some elements long.
constexpr int kLeastSide = 3 * kElement;
// The rounding to whole grey levels has a standard deviation of 1/sqrt(12) levels. In a smooth sky
// it makes patches of one level that no smoothing removes.
const double kLeastTypical = Level::kMeanResponse * kGreyScale / std::sqrt(12.0);

cv::Mat smoothed(const cv::Mat& picture) {
  cv::Mat result;
  cv::GaussianBlur(picture, result, {3, 3}, 0);
  return result;
}

// Samples beyond each side that the longest element reaches.
constexpr int kMargin = kLongElement - 1;

enum class Along { kRows, kColumns };
enum class Extreme { kLeast, kMost };
Extreme opposite(Extreme of) { return of == Extreme::kMost ? Extreme::kLeast : Extreme::kMost; }

cv::Mat extreme_of(const cv::Mat& a, const cv::Mat& b, Extreme extreme) {
  return extreme == Extreme::kMost ? cv::max(a, b) : cv::min(a, b);
}

// The extreme of every `length` neighbours, by doubling: of 1, 2, 4, ... and, of two that overlap,
// of all. The result is shorter by length - 1.
cv::Mat extreme_of(cv::Mat samples, Along along, int length, Extreme extreme) {
  for (int reached = 1; reached < length;) {
    const int shift = std::min(reached, length - reached);
    const int size = (along == Along::kRows ? samples.cols : samples.rows) - shift;
    const auto part = [&](int from) {
      return along == Along::kRows ? samples.colRange(from, from + size)
                                   : samples.rowRange(from, from + size);
    };
    samples = extreme_of(part(0), part(shift), extreme);
    reached += shift;
  }
  return samples;
}

// Closing (first the most, then the least) or opening by a line along rows or columns. `padded` has
// kMargin more samples on every side than the result.
cv::Mat filtered(const cv::Mat& padded, Along along, int length, Extreme first) {
  const int unused = kMargin - (length - 1);
  const cv::Size size(padded.cols - 2 * kMargin, padded.rows - 2 * kMargin);
  const cv::Mat used = along == Along::kRows
                           ? padded({unused, kMargin, size.width + 2 * (length - 1), size.height})
                           : padded({kMargin, unused, size.width, size.height + 2 * (length - 1)});
  return extreme_of(extreme_of(used, along, length, first), along, length, opposite(first));
}

// The picture without its dark (closing) or bright (opening) objects. An object is one along both
// directions: of two short elements, or of a short one across it and a long one along it.
cv::Mat without_objects(const cv::Mat& padded, Extreme first, bool with_long) {
  const cv::Mat row = filtered(padded, Along::kRows, kElement, first);
  const cv::Mat column = filtered(padded, Along::kColumns, kElement, first);
  const Extreme nearer = opposite(first);
  if (!with_long) return extreme_of(row, column, nearer);
  const cv::Mat wide = filtered(padded, Along::kRows, kLongElement, first);
  const cv::Mat high = filtered(padded, Along::kColumns, kLongElement, first);
  return extreme_of(extreme_of(wide, column, nearer), extreme_of(high, row, nearer), first);
}

cv::Mat close_minus_open(const cv::Mat& picture, bool with_long, cv::Mat& is_dark) {
  cv::Mat padded, dark, bright;
  cv::copyMakeBorder(picture, padded, kMargin, kMargin, kMargin, kMargin, cv::BORDER_REPLICATE);
  cv::subtract(without_objects(padded, Extreme::kMost, with_long), picture, dark);
  cv::subtract(picture, without_objects(padded, Extreme::kLeast, with_long), bright);
  cv::compare(dark, bright, is_dark, cv::CMP_GE);
  cv::max(dark, bright, dark);
  return dark;
}

// Mean and largest response of each block. A sum of eight responses fits 16 bits: none
// exceeds 255 * kGreyScale.
void block_statistics(const cv::Mat& response, cv::Mat& mean, cv::Mat& largest) {
  static_assert(kBlock == 8 && kBlock * 255 * kGreyScale < 32768);
  const cv::Size blocks = blocks_in(response.size());
  mean.create(blocks, CV_32F);
  largest.create(blocks, CV_16S);
  for (int by = 0; by < blocks.height; ++by)
    for (int bx = 0; bx < blocks.width; ++bx) {
      const cv::Point begin = block_in(response.size(), bx, by).tl();
      cv::v_int16x8 sum = cv::v_setzero_s16(), most = cv::v_setzero_s16();
      for (int y = 0; y < kBlock; ++y) {
        const cv::v_int16x8 samples = cv::v_load(response.ptr<short>(begin.y + y) + begin.x);
        sum = cv::v_add_wrap(sum, samples);
        most = cv::v_max(most, samples);
      }
      cv::v_int32x4 low, high;
      cv::v_expand(sum, low, high);
      mean.at<float>(by, bx) = static_cast<float>(cv::v_reduce_sum(low + high)) / (kBlock * kBlock);
      largest.at<short>(by, bx) = cv::v_reduce_max(most);
    }
}

// The median over 5 x 5 blocks: an object in the middle does not count, an edge of the sky does
// not spread.
cv::Mat typical_of(const cv::Mat& mean) {
  cv::Mat typical;
  cv::medianBlur(mean, typical, 5);
  cv::max(typical, kLeastTypical, typical);
  return typical;
}

// The mean of what is free of each block; where little is, that of the blocks around.
void without_hidden(const cv::Mat& hidden, cv::Mat& mean) {
  cv::Mat free_share(mean.size(), CV_32F);
  for (int by = 0; by < mean.rows; ++by)
    for (int bx = 0; bx < mean.cols; ++bx) {
      const cv::Mat block = hidden(block_in(hidden.size(), bx, by));
      const double share = 1 - cv::countNonZero(block) / double(kBlock * kBlock);
      free_share.at<float>(by, bx) = share < 0.5 ? 0.0F : static_cast<float>(share);
    }
  cv::divide(mean, cv::max(free_share, 0.5F), mean);
  fill(mean, free_share);
}

// Blocks on either side whose objects are a block's clutter, and those that its own object may
// reach into.
constexpr int kClutterReach = 10;
constexpr int kOwnReach = 2;

cv::Mat clutter_of(const Level& level) {
  cv::Mat squares(level.largest.size(), CV_64F, cv::Scalar(0)), sums;
  for (int by = 0; by < squares.rows; ++by)
    for (int bx = 0; bx < squares.cols; ++bx) {
      const double largest = level.largest.at<short>(by, bx);
      const bool is_object =
          largest >= kIsolated * static_cast<double>(level.typical.at<float>(by, bx)) &&
          level.is_peak(bx, by);
      if (is_object) squares.at<double>(by, bx) = largest * largest;
    }
  cv::integral(squares, sums, CV_64F);
  // The sum of the blocks within a reach, and how many they are.
  const auto within = [&](int bx, int by, int reach) {
    const cv::Rect blocks = cv::Rect(bx - reach, by - reach, 2 * reach + 1, 2 * reach + 1) &
                            cv::Rect({}, squares.size());
    return std::pair(sum_within(sums, blocks), blocks.area());
  };
  cv::Mat clutter(squares.size(), CV_32F, cv::Scalar(0));
  for (int by = 0; by < squares.rows; ++by)
    for (int bx = 0; bx < squares.cols; ++bx) {
      const auto [all, all_blocks] = within(bx, by, kClutterReach);
      const auto [own, own_blocks] = within(bx, by, kOwnReach);
      const double mean = (all - own) / std::max(1, all_blocks - own_blocks);
      clutter.at<float>(by, bx) = static_cast<float>(std::sqrt(std::max(0.0, mean)));
    }
  return clutter;
}

Level level_of(cv::Mat picture, int step, const cv::Mat& hidden) {
  Level level;
  level.step = step;
  level.hidden = hidden;
  level.picture = std::move(picture);
  if (step == 1) {
    // Eight bits take half the time, and the picture has no more.
    cv::Mat samples;
    level.picture.convertTo(samples, CV_8U, 1.0 / kGreyScale);
    close_minus_open(samples, false, level.is_dark).convertTo(level.response, CV_16S, kGreyScale);
  } else {
    level.response = close_minus_open(level.picture, true, level.is_dark);
  }
  if (!hidden.empty()) level.response.setTo(0, hidden);
  cv::Mat mean;
  block_statistics(level.response, mean, level.largest);
  if (!hidden.empty()) without_hidden(hidden, mean);
  level.typical = typical_of(mean);
  level.clutter = clutter_of(level);
  cv::Mat squares;
  cv::multiply(level.largest, level.largest, squares, 1, CV_64F);
  cv::integral(squares, level.largest_squares, CV_64F);
  return level;
}

// The value of the block that a sample lies in.
double at_block(const cv::Mat& blocks, const cv::Point& sample) {
  return static_cast<double>(blocks.at<float>(sample.y / kBlock, sample.x / kBlock));
}

}  // namespace

double Level::quietest() { return kLeastTypical; }

cv::Point Level::sample_at(const Pixel& pixel) const {
  return {static_cast<int>(std::lround((pixel.x() - 0.5) / step)),
          static_cast<int>(std::lround((pixel.y() - 0.5) / step))};
}

bool Level::is_peak(int bx, int by) const {
  const short here = largest.at<short>(by, bx);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const int x = bx + dx, y = by + dy;
      if (x < 0 || y < 0 || x >= largest.cols || y >= largest.rows) continue;
      const short there = largest.at<short>(y, x);
      const bool is_before = dy < 0 || (dy == 0 && dx < 0);
      if (there > here || (is_before && there == here)) return false;
    }
  return true;
}

double Level::noise_at(const cv::Point& sample) const {
  return at_block(typical, sample) / kMeanResponse;
}

double Level::clutter_at(const cv::Point& sample) const { return at_block(clutter, sample); }

double Level::relative_response(const cv::Point& sample) const {
  if (sample.x < 0 || sample.y < 0 || sample.x >= picture.cols || sample.y >= picture.rows)
    return 0;
  return response.at<short>(sample) / at_block(typical, sample);
}

cv::Point Level::strongest_near(const cv::Point& centre, int radius) const {
  cv::Point best = centre;
  double most = -1;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      const cv::Point sample = centre + cv::Point(dx, dy);
      const double here = relative_response(sample);
      if (here > most) {
        most = here;
        best = sample;
      }
    }
  return best;
}

std::vector<Level> scale_space(const image::Picture& picture, const FreeView& view) {
  std::vector<Level> levels;
  cv::Mat samples;
  view.luma(picture).convertTo(samples, CV_16S, kGreyScale);
  for (int step = 1; 4 * step <= kLargestPx; step *= 2) {
    if (std::min(samples.cols, samples.rows) < kLeastSide) break;
    samples = smoothed(samples);
    levels.push_back(level_of(samples, step, view.hidden(levels.size())));
    samples = halved(samples);
  }
  return levels;
}

}  // namespace airtruth::classical
