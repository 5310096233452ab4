// SPDX-License-Identifier: Apache-2.0
#include "detection/classical/scale_space.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

namespace airtruth::detection {
namespace {

// Least side of a level, in samples: some elements long.
constexpr int kLeastSide = 3 * kElement;
// Response of a picture that has no noise but the rounding to whole grey levels, whose standard
// deviation is 1/sqrt(12): it keeps a clear sky from dividing by nothing.
const double kLeastTypical = kGreyScale * kNoiseShare / std::sqrt(12.0) / 2;

cv::Mat luma_of(const image::Picture& picture) {
  const image::Plane& luma = picture.luma();
  // OpenCV has no matrix of constant samples; nothing writes to it.
  return cv::Mat(luma.height,
                 luma.width,
                 CV_8U,
                 const_cast<std::uint8_t*>(luma.row(0)),
                 static_cast<std::size_t>(luma.stride));
}

cv::Mat smoothed(const cv::Mat& picture) {
  cv::Mat result;
  cv::GaussianBlur(picture, result, {3, 3}, 0);
  return result;
}

// Every second sample of every second row.
cv::Mat halved(const cv::Mat& picture) {
  cv::Mat result;
  const cv::Mat even = picture({0, 0, picture.cols & ~1, picture.rows & ~1});
  cv::resize(even, result, {even.cols / 2, even.rows / 2}, 0, 0, cv::INTER_NEAREST);
  return result;
}

cv::Mat close_minus_open(const cv::Mat& picture) {
  static const cv::Mat row = cv::getStructuringElement(cv::MORPH_RECT, {kElement, 1});
  static const cv::Mat column = cv::getStructuringElement(cv::MORPH_RECT, {1, kElement});
  cv::Mat by_row, by_column, bright, dark;
  cv::morphologyEx(picture, by_row, cv::MORPH_CLOSE, row);
  cv::morphologyEx(picture, by_column, cv::MORPH_CLOSE, column);
  cv::min(by_row, by_column, by_row);
  cv::subtract(by_row, picture, dark);
  cv::morphologyEx(picture, by_row, cv::MORPH_OPEN, row);
  cv::morphologyEx(picture, by_column, cv::MORPH_OPEN, column);
  cv::max(by_row, by_column, by_row);
  cv::subtract(picture, by_row, bright);
  cv::max(dark, bright, dark);
  return dark;
}

// Mean and largest response of each whole block. A sum of eight responses fits 16 bits: none
// exceeds 255 * kGreyScale.
void block_statistics(const cv::Mat& response, cv::Mat& mean, cv::Mat& largest) {
  static_assert(kBlock == 8 && kBlock * 255 * kGreyScale < 32768);
  const int columns = response.cols / kBlock, rows = response.rows / kBlock;
  mean.create(rows, columns, CV_32F);
  largest.create(rows, columns, CV_16S);
  for (int by = 0; by < rows; ++by)
    for (int bx = 0; bx < columns; ++bx) {
      cv::v_int16x8 sum = cv::v_setzero_s16(), most = cv::v_setzero_s16();
      for (int y = 0; y < kBlock; ++y) {
        const cv::v_int16x8 samples =
            cv::v_load(response.ptr<short>(by * kBlock + y) + bx * kBlock);
        sum = cv::v_add_wrap(sum, samples);
        most = cv::v_max(most, samples);
      }
      cv::v_int32x4 low, high;
      cv::v_expand(sum, low, high);
      mean.at<float>(by, bx) =
          static_cast<float>(cv::v_reduce_sum(low + high)) / (kBlock * kBlock);
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

Level level_of(cv::Mat picture, int step) {
  Level level;
  level.step = step;
  level.picture = std::move(picture);
  level.response = close_minus_open(level.picture);
  cv::Mat mean;
  block_statistics(level.response, mean, level.largest);
  level.typical = typical_of(mean);
  return level;
}

}  // namespace

cv::Point Level::sample_at(const Pixel& pixel) const {
  return {static_cast<int>(std::lround((pixel.x() - 0.5) / step)),
          static_cast<int>(std::lround((pixel.y() - 0.5) / step))};
}

double Level::relative_response(const cv::Point& sample) const {
  if (sample.x < 0 || sample.y < 0 || sample.x >= picture.cols || sample.y >= picture.rows)
    return 0;
  const int bx = std::min(sample.x / kBlock, typical.cols - 1);
  const int by = std::min(sample.y / kBlock, typical.rows - 1);
  return response.at<short>(sample) / static_cast<double>(typical.at<float>(by, bx));
}

double Level::relative_response_near(const cv::Point& sample, int radius) const {
  double largest_there = 0;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x)
      largest_there = std::max(largest_there, relative_response({sample.x + x, sample.y + y}));
  return largest_there;
}

std::vector<Level> scale_space(const image::Picture& picture) {
  std::vector<Level> levels;
  cv::Mat samples;
  luma_of(picture).convertTo(samples, CV_16S, kGreyScale);
  for (int step = 1; 4 * step <= kLargestPx; step *= 2) {
    if (std::min(samples.cols, samples.rows) < kLeastSide) break;
    samples = smoothed(samples);
    levels.push_back(level_of(samples, step));
    samples = halved(samples);
  }
  return levels;
}

}  // namespace airtruth::detection
