// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/patch.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace airtruth::motion {
namespace {

// Where a constant of this file states no origin, it is chosen by judgement; docs/optimisations.md
// has what was tried.

constexpr int kLumaSteps = 8;  // of Patch::luma_ in a code value
// Sampling positions are sixteenths of a sample, so that bilinear weights are integers that sum to
// 256. The result is not rounded: a search linearises about such a position.
constexpr int kPositionSteps = 16;
constexpr int kWeightSum = kPositionSteps * kPositionSteps;
// The weight of a sample is that of its column times that of its row.
constexpr std::array<int, kPatchPx> kWeights = {1, 2, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 3, 2, 1};
constexpr std::array<std::int16_t, kPatchPx * kPatchPx> weights() {
  std::array<std::int16_t, kPatchPx * kPatchPx> all{};
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = static_cast<std::int16_t>(kWeights[i / kPatchPx] * kWeights[i % kPatchPx]);
  return all;
}
constexpr std::array<std::int16_t, kPatchPx* kPatchPx> kWeight = weights();
constexpr double kWeightOfAll = 52.0 * 52.0;  // the sum of kWeight
// The least eigenvalue of the normal matrix, per sample, in squared code values per sample. At
// 0.05, patches of coded blocks that stand still win (docs/optimisations.md).
constexpr double kMinEigenvalue = 0.2;
// The variance of the difference of two pictures by noise alone, in squared code values: that of a
// cheap camera.
constexpr double kNoiseVariance = 4;
// Rounds of a search at most. Chosen by judgement; twice as many cost time where nothing is found.
constexpr int kMaxRounds = 8;
// A search ends after a step of less than this many samples: the next step would be shorter by an
// order of magnitude.
constexpr double kSettledPx = 0.06;
// After the last round, a step of up to this many samples still counts as settled.
constexpr double kLooselySettledPx = 0.5;
// The longest way from the guess, in samples.
constexpr double kMaxWayPx = 5;

// A patch is found where what remains is at most this share of the patch's contrast.
constexpr double kMaxUnlikeness = 0.7;

double scale_of(int level) { return static_cast<double>(1 << level); }

double squared(double x, double y) { return x * x + y * y; }

}  // namespace

std::optional<Patch> Patch::at(const cv::Mat& grey, int x, int y) {
  if (x < 1 || y < 1 || x + kPatchPx >= grey.cols || y + kPatchPx >= grey.rows) return std::nullopt;
  Patch patch;
  std::int16_t x_difference[kSamples], y_difference[kSamples], luma[kSamples];
  for (int row = 0; row < kPatchPx; ++row) {
    const std::uint8_t* above = grey.ptr<std::uint8_t>(y + row - 1) + x;
    const std::uint8_t* here = grey.ptr<std::uint8_t>(y + row) + x;
    const std::uint8_t* below = grey.ptr<std::uint8_t>(y + row + 1) + x;
    const int first = row * kPatchPx;
    for (int i = 0; i < kPatchPx; ++i) {
      luma[first + i] = here[i];
      x_difference[first + i] = static_cast<std::int16_t>(here[i + 1] - here[i - 1]);
      y_difference[first + i] = static_cast<std::int16_t>(below[i] - above[i]);
    }
  }
  for (std::size_t i = 0; i < kSamples; ++i) {
    patch.luma_[i] = static_cast<std::int16_t>(luma[i] * kLumaSteps);
    patch.slope_x_[i] = static_cast<std::int16_t>(x_difference[i] * kWeight[i]);
    patch.slope_y_[i] = static_cast<std::int16_t>(y_difference[i] * kWeight[i]);
  }
  // All factors have 16 bits: compilers multiply and add eight pairs in one instruction.
  int sum = 0, squares = 0, sum_x = 0, sum_y = 0, xx = 0, xy = 0, yy = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    sum += luma[i];
    squares += luma[i] * luma[i];
    sum_x += patch.slope_x_[i];
    sum_y += patch.slope_y_[i];
    xx += patch.slope_x_[i] * x_difference[i];
    xy += patch.slope_x_[i] * y_difference[i];
    yy += patch.slope_y_[i] * y_difference[i];
  }
  patch.mean_slope_x_ = double(sum_x) / kWeightOfAll;
  patch.mean_slope_y_ = double(sum_y) / kWeightOfAll;
  // Per sample, of the slopes about their mean; a slope is half the difference of the neighbours.
  const auto moment = [](int sum_of_products, double mean_1, double mean_2) {
    return (double(sum_of_products) / kWeightOfAll - mean_1 * mean_2) / 4;
  };
  const double a = moment(xx, patch.mean_slope_x_, patch.mean_slope_x_);
  const double b = moment(xy, patch.mean_slope_x_, patch.mean_slope_y_);
  const double c = moment(yy, patch.mean_slope_y_, patch.mean_slope_y_);
  if ((a + c) / 2 - std::sqrt((a - c) * (a - c) / 4 + b * b) < kMinEigenvalue) return std::nullopt;
  const double determinant = a * c - b * b;
  patch.inverse_xx_ = c / determinant;
  patch.inverse_xy_ = -b / determinant;
  patch.inverse_yy_ = a / determinant;
  const double mean = double(sum) / kSamples;
  patch.contrast_ = std::sqrt(std::max(0.0, double(squares) / kSamples - mean * mean));
  return patch;
}

// The sums over a patch of what a picture has more than the patch, in kLumaSteps a code value. They
// keep within 32 bits: the largest is 255 x 2,040 x kWeightOfAll = 1.4e9.
struct Patch::Difference {
  int times_slope_x = 0, times_slope_y = 0;
  int weighted = 0;
  int sum = 0, squares = 0;
};

Patch::Difference Patch::difference(const cv::Mat& grey, int x_16th, int y_16th) const {
  const int x = x_16th / kPositionSteps, y = y_16th / kPositionSteps;
  const int right = x_16th % kPositionSteps, down = y_16th % kPositionSteps;
  const auto weight = [](int a, int b) { return static_cast<std::uint16_t>(a * b); };
  const std::uint16_t w00 = weight(kPositionSteps - right, kPositionSteps - down);
  const std::uint16_t w01 = weight(right, kPositionSteps - down);
  const std::uint16_t w10 = weight(kPositionSteps - right, down);
  const std::uint16_t w11 = weight(right, down);
  std::int16_t more[kSamples];
  for (int row = 0; row < kPatchPx; ++row) {
    const std::uint8_t* upper = grey.ptr<std::uint8_t>(y + row) + x;
    const std::uint8_t* lower = grey.ptr<std::uint8_t>(y + row + 1) + x;
    const std::int16_t* luma = &luma_[static_cast<std::size_t>(row * kPatchPx)];
    std::int16_t* row_of_more = &more[row * kPatchPx];
    for (int i = 0; i < kPatchPx; ++i) {
      const auto sample = static_cast<std::uint16_t>(upper[i] * w00 + upper[i + 1] * w01 +
                                                     lower[i] * w10 + lower[i + 1] * w11);
      // Bits by which a weighted sum is finer than Patch::luma_.
      constexpr int kShift = 5;
      static_assert(kWeightSum >> kShift == kLumaSteps);
      row_of_more[i] = static_cast<std::int16_t>((sample >> kShift) - luma[i]);
    }
  }
  Difference all;  // factors of 16 bits, as in at()
  for (std::size_t i = 0; i < kSamples; ++i) {
    all.times_slope_x += more[i] * slope_x_[i];
    all.times_slope_y += more[i] * slope_y_[i];
    all.weighted += more[i] * kWeight[i];
    all.sum += more[i];
    all.squares += more[i] * more[i];
  }
  return all;
}

std::optional<Patch::Found> Patch::find(const cv::Mat& grey, double guess_x, double guess_y) const {
  double x = guess_x, y = guess_y;
  for (int round = 0; round < kMaxRounds; ++round) {
    const int x_16th = static_cast<int>(std::lround(x * kPositionSteps));
    const int y_16th = static_cast<int>(std::lround(y * kPositionSteps));
    if (x_16th < 0 || y_16th < 0 || x_16th / kPositionSteps + kPatchPx >= grey.cols ||
        y_16th / kPositionSteps + kPatchPx >= grey.rows)
      return std::nullopt;
    const Difference more = difference(grey, x_16th, y_16th);
    const double mean = double(more.weighted) / kWeightOfAll;
    constexpr double kScale = 1.0 / (2 * kLumaSteps);  // half the neighbours' difference is a slope
    const double bx = kScale * (double(more.times_slope_x) / kWeightOfAll - mean * mean_slope_x_);
    const double by = kScale * (double(more.times_slope_y) / kWeightOfAll - mean * mean_slope_y_);
    const double step_x = -(inverse_xx_ * bx + inverse_xy_ * by);
    const double step_y = -(inverse_xy_ * bx + inverse_yy_ * by);
    const double from_x = double(x_16th) / kPositionSteps;
    const double from_y = double(y_16th) / kPositionSteps;
    const double unsettled = squared(from_x + step_x - x, from_y + step_y - y);
    x = from_x + step_x, y = from_y + step_y;
    if (squared(x - guess_x, y - guess_y) > kMaxWayPx * kMaxWayPx) return std::nullopt;
    if (unsettled > kSettledPx * kSettledPx && round + 1 < kMaxRounds) continue;
    if (unsettled > kLooselySettledPx * kLooselySettledPx) return std::nullopt;
    const double m = double(more.sum) / kSamples;
    const double variance = (double(more.squares) / kSamples - m * m) / (kLumaSteps * kLumaSteps);
    return Found{x, y, std::sqrt(std::max(0.0, variance - kNoiseVariance)) / contrast_};
  }
  return std::nullopt;
}

Levels levels_of(const cv::Mat& grey) {
  // The coarsest level has at least this many samples on its shorter side: a patch is a third of
  // it.
  constexpr int kMinSide = 48;
  Levels levels{grey};
  while (std::min(levels.back().cols, levels.back().rows) / 2 >= kMinSide) {
    const cv::Mat& fine = levels.back();
    const cv::Mat even = fine(cv::Rect(0, 0, fine.cols / 2 * 2, fine.rows / 2 * 2));
    cv::Mat half;
    cv::resize(even, half, {even.cols / 2, even.rows / 2}, 0, 0, cv::INTER_AREA);
    levels.push_back(std::move(half));
  }
  return levels;
}

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
