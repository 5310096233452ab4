// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "foundation/base/vectors.h"

namespace airtruth::motion {
namespace {

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
constexpr double kWeightOfAll = 52.0 * 52.0;
// The least eigenvalue of the normal matrix, per sample, in squared code values per sample.
constexpr double kMinEigenvalue = 0.2;
// The variance of the difference of two pictures by noise alone, in squared code values: that of a
// cheap camera.
constexpr double kNoiseVariance = 4;
constexpr int kMaxRounds = 8;
// A search ends after a step of less than this many samples: the next step would be shorter by an
// order of magnitude.
constexpr double kSettledPx = 0.06;
// After the last round, a step of up to this many samples still counts as settled.
constexpr double kLooselySettledPx = 0.5;
// The longest way from the guess, in samples.
constexpr double kMaxWayPx = 5;

// The sums over a patch of its luma in code values, of its slopes as in Patch, and of their
// products with the slopes without weight.
struct PatchSums {
  int luma = 0, squares = 0;
  int slope_x = 0, slope_y = 0;
  int xx = 0, xy = 0, yy = 0;
};

// All factors have 16 bits: compilers multiply and add eight or more pairs in one instruction.
// `first`: the first sample of the patch.
AIRTRUTH_FOR_VECTORS
PatchSums prepare(const std::uint8_t* first,
                  std::ptrdiff_t stride,
                  std::int16_t* __restrict luma_in_steps,
                  std::int16_t* __restrict slope_x,
                  std::int16_t* __restrict slope_y) {
  constexpr int kSamples = kPatchPx * kPatchPx;
  std::int16_t x_difference[kSamples], y_difference[kSamples], luma[kSamples];
  for (int row = 0; row < kPatchPx; ++row) {
    const std::uint8_t* here = first + row * stride;
    const std::uint8_t* above = here - stride;
    const std::uint8_t* below = here + stride;
    const int to = row * kPatchPx;
    for (int i = 0; i < kPatchPx; ++i) {
      luma[to + i] = here[i];
      x_difference[to + i] = static_cast<std::int16_t>(here[i + 1] - here[i - 1]);
      y_difference[to + i] = static_cast<std::int16_t>(below[i] - above[i]);
    }
  }
  for (std::size_t i = 0; i < kSamples; ++i) {
    luma_in_steps[i] = static_cast<std::int16_t>(luma[i] * kLumaSteps);
    slope_x[i] = static_cast<std::int16_t>(x_difference[i] * kWeight[i]);
    slope_y[i] = static_cast<std::int16_t>(y_difference[i] * kWeight[i]);
  }
  PatchSums sums;
  for (std::size_t i = 0; i < kSamples; ++i) {
    sums.luma += luma[i];
    sums.squares += luma[i] * luma[i];
    sums.slope_x += slope_x[i];
    sums.slope_y += slope_y[i];
    sums.xx += slope_x[i] * x_difference[i];
    sums.xy += slope_x[i] * y_difference[i];
    sums.yy += slope_y[i] * y_difference[i];
  }
  return sums;
}

}  // namespace

std::optional<Patch> Patch::at(const cv::Mat& grey, int x, int y) {
  if (x < 1 || y < 1 || x + kPatchPx >= grey.cols || y + kPatchPx >= grey.rows) return std::nullopt;
  Patch patch;
  const PatchSums sums = prepare(grey.ptr<std::uint8_t>(y) + x,
                                 static_cast<std::ptrdiff_t>(grey.step),
                                 patch.luma_.data(),
                                 patch.slope_x_.data(),
                                 patch.slope_y_.data());
  patch.mean_slope_x_ = double(sums.slope_x) / kWeightOfAll;
  patch.mean_slope_y_ = double(sums.slope_y) / kWeightOfAll;
  // Per sample, of the slopes about their mean; a slope is half the difference of the neighbours.
  const auto moment = [](int sum_of_products, double mean_1, double mean_2) {
    return (double(sum_of_products) / kWeightOfAll - mean_1 * mean_2) / 4;
  };
  const double a = moment(sums.xx, patch.mean_slope_x_, patch.mean_slope_x_);
  const double b = moment(sums.xy, patch.mean_slope_x_, patch.mean_slope_y_);
  const double c = moment(sums.yy, patch.mean_slope_y_, patch.mean_slope_y_);
  if ((a + c) / 2 - std::sqrt((a - c) * (a - c) / 4 + b * b) < kMinEigenvalue) return std::nullopt;
  const double determinant = a * c - b * b;
  patch.inverse_xx_ = c / determinant;
  patch.inverse_xy_ = -b / determinant;
  patch.inverse_yy_ = a / determinant;
  const double mean = double(sums.luma) / kSamples;
  patch.contrast_ = std::sqrt(std::max(0.0, double(sums.squares) / kSamples - mean * mean));
  return patch;
}

namespace {

// The sums over a patch of what a picture has more than the patch, in kLumaSteps a code value. They
// keep within 32 bits: the largest is 255 x 2,040 x kWeightOfAll = 1.4e9.
struct Difference {
  int times_slope_x = 0, times_slope_y = 0;
  int weighted = 0;
  int sum = 0, squares = 0;
};

// What a picture has more than a patch, by sample. `first`: the sample of the picture at or before
// the first of the patch. right, down: from there to the first of the patch, in kPositionSteps.
[[gnu::always_inline]] inline void subtract(const std::uint8_t* first,
                                            std::ptrdiff_t stride,
                                            int right,
                                            int down,
                                            const std::int16_t* luma,
                                            std::int16_t* __restrict more) {
  const auto weight = [](int a, int b) { return static_cast<std::uint16_t>(a * b); };
  const std::uint16_t w00 = weight(kPositionSteps - right, kPositionSteps - down);
  const std::uint16_t w01 = weight(right, kPositionSteps - down);
  const std::uint16_t w10 = weight(kPositionSteps - right, down);
  const std::uint16_t w11 = weight(right, down);
  for (int row = 0; row < kPatchPx; ++row) {
    const std::uint8_t* upper = first + row * stride;
    const std::uint8_t* lower = upper + stride;
    const std::int16_t* luma_of_row = luma + row * kPatchPx;
    std::int16_t* more_of_row = more + row * kPatchPx;
    for (int i = 0; i < kPatchPx; ++i) {
      const auto sample = static_cast<std::uint16_t>(upper[i] * w00 + upper[i + 1] * w01 +
                                                     lower[i] * w10 + lower[i + 1] * w11);
      constexpr int kShift = 5;
      static_assert(kWeightSum >> kShift == kLumaSteps);
      more_of_row[i] = static_cast<std::int16_t>((sample >> kShift) - luma_of_row[i]);
    }
  }
}

// first, stride, right, down, luma: as in subtract().
AIRTRUTH_FOR_VECTORS
Difference sum_difference(const std::uint8_t* first,
                          std::ptrdiff_t stride,
                          int right,
                          int down,
                          const std::int16_t* luma,
                          const std::int16_t* slope_x,
                          const std::int16_t* slope_y) {
  constexpr int kSamples = kPatchPx * kPatchPx;
  std::int16_t more[kSamples];
  subtract(first, stride, right, down, luma, more);
  Difference sums;
  for (std::size_t i = 0; i < kSamples; ++i) {  // factors of 16 bits, as in prepare()
    sums.times_slope_x += more[i] * slope_x[i];
    sums.times_slope_y += more[i] * slope_y[i];
    sums.weighted += more[i] * kWeight[i];
    sums.sum += more[i];
    sums.squares += more[i] * more[i];
  }
  return sums;
}

double squared(double x, double y) { return x * x + y * y; }

}  // namespace

std::optional<Patch::Found> Patch::find(const cv::Mat& grey, double guess_x, double guess_y) const {
  double x = guess_x, y = guess_y;
  for (int round = 0; round < kMaxRounds; ++round) {
    const int x_16th = static_cast<int>(std::lround(x * kPositionSteps));
    const int y_16th = static_cast<int>(std::lround(y * kPositionSteps));
    if (x_16th < 0 || y_16th < 0 || x_16th / kPositionSteps + kPatchPx >= grey.cols ||
        y_16th / kPositionSteps + kPatchPx >= grey.rows)
      return std::nullopt;
    const Difference more =
        sum_difference(grey.ptr<std::uint8_t>(y_16th / kPositionSteps) + x_16th / kPositionSteps,
                       static_cast<std::ptrdiff_t>(grey.step),
                       x_16th % kPositionSteps,
                       y_16th % kPositionSteps,
                       luma_.data(),
                       slope_x_.data(),
                       slope_y_.data());
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

}  // namespace airtruth::motion
