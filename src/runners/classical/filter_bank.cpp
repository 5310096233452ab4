// SPDX-License-Identifier: Apache-2.0
#include "runners/classical/filter_bank.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "foundation/base/error.h"

namespace airtruth::classical {
namespace {

// Standard deviation of a target's response in units of the typical one: that of the noise.
constexpr double kSpread = 1.25;
constexpr int kStrengths = 64;  // of a target, over which the mean is taken: 14 an octave
// Levels whose responses are measurements: for objects of up to 32 px across, and three times as
// long. Of larger ones, parts respond.
constexpr std::size_t kLevelsOfMeasurement = 4;

// Relative responses of a level, one for each sample, in 8 bits.
cv::Mat relative_responses(const Level& level) {
  cv::Mat relative(level.response.size(), CV_8U, cv::Scalar(0));
  for (int y = 0; y < relative.rows; ++y) {
    const short* response = level.response.ptr<short>(y);
    const float* typical = level.typical.ptr<float>(y / kBlock);
    std::uint8_t* out = relative.ptr<std::uint8_t>(y);
    for (int bx = 0; bx < level.typical.cols; ++bx) {
      // Fixed point: 256 parts of a part.
      const int factor =
          static_cast<int>(std::lround(256.0 * kPartsOfTypical / static_cast<double>(typical[bx])));
      for (int x = bx * kBlock; x < std::min(relative.cols, (bx + 1) * kBlock); ++x)
        out[x] = static_cast<std::uint8_t>(std::min(255, response[x] * factor >> 8));
    }
  }
  return relative;
}

// The values of a grid of that size, whose last cells may lie outside of the picture: 0 there.
cv::Mat fitted(const cv::Mat& values, const cv::Size& size) {
  if (values.size() == size) return values;
  cv::Mat result(size, values.type(), cv::Scalar(0));
  const cv::Rect both = cv::Rect({}, values.size()) & cv::Rect({}, size);
  values(both).copyTo(result(both));
  return result;
}

// The largest of every `factor` x `factor` samples, for a grid of that size.
cv::Mat largest_of(const cv::Mat& samples, int factor, const cv::Size& size) {
  cv::Mat largest, result;
  // Of a sample and those after it along both directions, at every factor-th sample.
  cv::dilate(samples, largest, cv::Mat::ones(factor, factor, CV_8U), {0, 0});
  cv::resize(fitted(largest, size * factor), result, size, 0, 0, cv::INTER_NEAREST);
  return result;
}

cv::Mat clutter_of(const Level& level, const cv::Size& cells) {
  const double quiet = level.quietest();
  cv::Mat classes(level.typical.size(), CV_8U);
  for (int y = 0; y < classes.rows; ++y)
    for (int x = 0; x < classes.cols; ++x) {
      const double octaves = std::log2(level.typical.at<float>(y, x) / quiet);
      classes.at<std::uint8_t>(y, x) =
          static_cast<std::uint8_t>(std::clamp(static_cast<int>(octaves), 0, kClutterClasses - 1));
    }
  cv::Mat result;
  constexpr int kCellsOfBlock = kBlock / 2;
  cv::resize(classes, result, {}, kCellsOfBlock, kCellsOfBlock, cv::INTER_NEAREST);
  return fitted(result, cells);
}

}  // namespace

Measurement measurement_of(const std::vector<Level>& levels, const cv::Size& cells) {
  cv::Mat coarse;
  const std::size_t count = std::min(levels.size(), kLevelsOfMeasurement);
  for (std::size_t i = count; i-- > 1;) {
    const cv::Mat here = relative_responses(levels[i]);
    if (coarse.empty()) {
      coarse = here;
      continue;
    }
    cv::Mat enlarged;
    cv::resize(coarse, enlarged, here.size(), 0, 0, cv::INTER_NEAREST);
    cv::max(enlarged, here, coarse);
  }
  Measurement measurement;
  measurement.response = largest_of(relative_responses(levels.front()), 2, cells);
  if (!coarse.empty()) {
    cv::max(measurement.response, fitted(coarse, cells), measurement.response);
  }
  measurement.clutter = clutter_of(levels.front(), cells);
  return measurement;
}

Measurement coarser(const Measurement& measurement, int factor, const cv::Size& cells) {
  Measurement result;
  result.response = largest_of(measurement.response, factor, cells);
  cv::resize(
      fitted(measurement.clutter, cells * factor), result.clutter, cells, 0, 0, cv::INTER_NEAREST);
  return result;
}

LikelihoodRatio::LikelihoodRatio() {
  for (int k = 0; k < kStrengths; ++k) {
    const double strength =
        kWeakest * std::pow(kStrongest / kWeakest, k / static_cast<double>(kStrengths - 1));
    for (int m = 0; m < 256; ++m) {
      const double off = (static_cast<double>(m) / kPartsOfTypical - strength) / kSpread;
      target_[static_cast<std::size_t>(m)] += std::exp(-0.5 * off * off);
    }
  }
  double sum = 0;
  for (const double share : target_) sum += share;
  for (double& share : target_) share /= sum;
}

void LikelihoodRatio::learn(const Measurement& measurement) {
  for (auto& counts : counts_)
    for (double& count : counts) count *= 1 - 1 / kMemoryFrames;
  std::array<std::array<int, 256>, kClutterClasses> now{};
  for (int y = 0; y < measurement.response.rows; ++y) {
    const std::uint8_t* response = measurement.response.ptr<std::uint8_t>(y);
    const std::uint8_t* clutter = measurement.clutter.ptr<std::uint8_t>(y);
    for (int x = 0; x < measurement.response.cols; ++x) ++now[clutter[x]][response[x]];
  }
  for (std::size_t c = 0; c < kClutterClasses; ++c) {
    double sum = 0;
    for (std::size_t m = 0; m < 256; ++m) {
      counts_[c][m] += now[c][m];
      sum += counts_[c][m];
    }
    // The strongest responses of a frame are counted over five bins, since single bins of the tail
    // are empty or hold a target.
    double largest = kHidden;
    for (std::size_t m = 0; m < 256; ++m) {
      double near = 1;
      const std::size_t low = m < 2 ? 0 : m - 2, high = std::min<std::size_t>(255, m + 2);
      for (std::size_t k = low; k <= high; ++k) near += counts_[c][k];
      const double clutter = near / static_cast<double>(high - low + 1) / std::max(sum, 1.0);
      const double ratio = kHidden + (1 - kHidden) * target_[m] / clutter;
      largest = std::clamp(ratio, largest, std::max(largest, kLargest));
      ratios_[c][m] = static_cast<float>(sum > 0 ? largest : 1.0);
    }
  }
}

namespace {

// Odds have a rim of one cell, so that every cell has neighbours. The rim keeps the odds 1: a
// target may enter there as anywhere.
constexpr int kRim = 4;  // columns; a whole vector, so that rows stay aligned

cv::Mat cells_of(const cv::Mat& rimmed) {
  return rimmed({kRim, 1, rimmed.cols - 2 * kRim, rimmed.rows - 2});
}

// x ^ kRemembers for positive x. The bits of a float, as a whole number, are its logarithm to base
// 2 but for a scale, an offset and an error below 0.09: the power is a product. Within 4 %.
constexpr float kBitsOfOne = 127 * (1 << 23);

cv::v_float32x4 remembered(const cv::v_float32x4& x) {
  // An exponent without a unit.
  constexpr float kPower = static_cast<float>(FilterBank::kRemembers);
  const cv::v_float32x4 bits = cv::v_cvt_f32(cv::v_reinterpret_as_s32(x));
  return cv::v_reinterpret_as_f32(
      cv::v_round(bits * cv::v_setall_f32(kPower) + cv::v_setall_f32((1 - kPower) * kBitsOfOne)));
}

// One filter's row, of a multiple of four cells. `there` is the row, and `dx` the column, from
// which a target comes.
void update_row(const float* here,
                const float* there,
                int dx,
                const float* ratio,
                float* out,
                float* mean,
                int width) {
  const cv::v_float32x4 stays = cv::v_setall_f32(static_cast<float>(FilterBank::kStays / 4));
  const cv::v_float32x4 born = cv::v_setall_f32(static_cast<float>(1 - FilterBank::kStays));
  const cv::v_float32x4 quarter = cv::v_setall_f32(0.25F);
  for (int x = 0; x < width; x += 4) {
    const cv::v_float32x4 sum = (cv::v_load(here + x) + cv::v_load(here + x + dx)) +
                                (cv::v_load(there + x) + cv::v_load(there + x + dx));
    const cv::v_float32x4 odds = cv::v_load(ratio + x) * remembered(stays * sum + born);
    cv::v_store(out + x, odds);
    cv::v_store(mean + x, cv::v_load(mean + x) + quarter * odds);
  }
}

}  // namespace

FilterBank::FilterBank(const cv::Size& cells) : mean_(cells, CV_32F, cv::Scalar(1)) {
  check(cells.width % 4 == 0, "a row of cells is a whole number of vectors");
  for (auto* bank : {&odds_, &before_})
    for (cv::Mat& odds : *bank)
      odds = cv::Mat(cells.height + 2, cells.width + 2 * kRim, CV_32F, cv::Scalar(1));
}

void FilterBank::carry(const cv::Mat& former_from_new) {
  for (cv::Mat& odds : odds_) {
    cv::Mat moved;
    cv::remap(cells_of(odds),
              moved,
              former_from_new,
              {},
              cv::INTER_LINEAR,
              cv::BORDER_CONSTANT,
              cv::Scalar(1));
    moved.copyTo(cells_of(odds));
  }
}

void FilterBank::update(const cv::Mat& ratio) {
  std::swap(odds_, before_);
  mean_.setTo(0);
  for (std::size_t filter = 0; filter < odds_.size(); ++filter) {
    const int dx = filter % 2 == 0 ? -1 : 1, dy = filter < 2 ? -1 : 1;
    for (int y = 0; y < mean_.rows; ++y)
      update_row(before_[filter].ptr<float>(y + 1) + kRim,
                 before_[filter].ptr<float>(y + 1 + dy) + kRim,
                 dx,
                 ratio.ptr<float>(y),
                 odds_[filter].ptr<float>(y + 1) + kRim,
                 mean_.ptr<float>(y),
                 mean_.cols);
  }
}

}  // namespace airtruth::classical
