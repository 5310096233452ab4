// SPDX-License-Identifier: Apache-2.0
#include "calibration/sensor/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "foundation/base/median.h"
#include "foundation/image/colour.h"
#include "picture/composite/sensor.h"
#include "picture/composite/spread.h"

namespace airtruth::sensor {
namespace {

// Where a constant of this file states no origin, it was chosen on the virtual flights of
// camera_slow_test.cpp, whose figures are in docs/realism.md.

// Side of a block, px.
constexpr int kSide = 12;
// Number of brightnesses, of equal width in coded luma.
constexpr int kBins = 24;
// Share of the blocks of one brightness that are taken as flat.
constexpr double kFlatShare = 0.12;
// Fewest flat blocks of one brightness.
constexpr std::size_t kMinBlocks = 12;
// Variance of rounding to whole code values, squared code values.
constexpr double kRounding = 1.0 / 12;
// Distances from black and from white, code values, within which luma counts as clipped.
constexpr double kAboveBlack = 2, kBelowWhite = 5;
// Upper bound of the weight of a point of the curve, blocks, so that the many blocks of sky do not
// dominate the dark points.
constexpr int kMaxBlocksOfWeight = 40;
// Relative excess of a point over the curve from which on it counts as texture.
constexpr double kTextureExcess = 0.04;
// Bound of a squared relative residual, so that texture does not widen the error.
constexpr double kMaxSquaredResidual = 0.02;
// Least mean of a squared relative residual times the number of its blocks: the variance that
// chance gives a block's variance (2 / degrees of freedom), pi / 2 times that in their median.
constexpr double kLeastScatter = std::numbers::pi / (kSide * kSide - 3);
// Below this variance in linear light the noise is 0; it corresponds to a hundredth of a code
// value.
constexpr double kMinVariance = 1e-9;

struct Statistics {
  double mean = 0;
  double variance = 0;
  double covariance = 0;
  int least = 255, most = 0;  // luma
};

// Statistics of a block after the best-fitting plane is subtracted. The plane has three degrees of
// freedom and takes a little of the noise with it; the divisor n - 3 corrects for that.
Statistics statistics_of(const image::Picture& picture, int x0, int y0) {
  // Middle of the block and number of its pixels.
  constexpr double kHalf = (kSide - 1) / 2.0;
  constexpr double kCount = kSide * kSide;
  double sum = 0, sum_x = 0, sum_y = 0, squares = 0;
  Statistics result;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const int v = image::luma_at(picture, x0 + x, y0 + y);
      result.least = std::min(result.least, v);
      result.most = std::max(result.most, v);
      sum += v;
      sum_x += v * (x - kHalf);
      sum_y += v * (y - kHalf);
      squares += (x - kHalf) * (x - kHalf);
    }
  result.mean = sum / kCount;
  const double slope_x = sum_x / squares;
  const double slope_y = sum_y / squares;
  std::array<std::array<double, kSide>, kSide> rest;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      rest[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] =
          image::luma_at(picture, x0 + x, y0 + y) - result.mean - slope_x * (x - kHalf) -
          slope_y * (y - kHalf);
  double same = 0, beside = 0;
  for (std::size_t y = 0; y < kSide; ++y)
    for (std::size_t x = 0; x < kSide; ++x) {
      same += rest[y][x] * rest[y][x];
      if (x + 1 < kSide) beside += rest[y][x] * rest[y][x + 1];
      if (y + 1 < kSide) beside += rest[y][x] * rest[y + 1][x];
    }
  result.variance = same / (kCount - 3);
  result.covariance = beside / (2 * kSide * (kSide - 1));
  return result;
}

// Correlation between neighbouring pixels of white noise after a Gaussian blur with the standard
// deviation `sigma_px`.
double neighbour_correlation(double sigma_px) {
  const std::vector<float> kernel = composite::gaussian(sigma_px);
  double same = 0, beside = 0;
  for (std::size_t i = 0; i < kernel.size(); ++i) {
    same += double(kernel[i]) * double(kernel[i]);
    if (i + 1 < kernel.size()) beside += double(kernel[i]) * double(kernel[i + 1]);
  }
  return beside / same;
}

double width_from_correlation(double correlation) {
  double low = 0, high = 5;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (neighbour_correlation(middle) < correlation ? low : high) = middle;
  }
  return high < 0.05 ? 0 : 0.5 * (low + high);
}

// A point of the noise curve in linear light: its light x, its variance y, and the number of
// blocks.
struct CurvePoint {
  double x, y, blocks;
};

// One weighted least-squares fit, whose parameters are not negative.
struct LineFit {
  double gain = 0, floor = 0;
  // Sums of the weights and of weight x^2, and the determinant of the normal equations.
  double sw = 0, sxx = 0, det = 0;
};

// The fit with the weights that follow from the fit `before`; nullptr for the first.
LineFit line_fit(const std::vector<CurvePoint>& points, const LineFit* before) {
  LineFit fit;
  double sx = 0, sy = 0, sxy = 0;
  for (const auto& [x, y, blocks] : points) {
    const double expected = before == nullptr ? y : before->gain * x + before->floor;
    // The error of a variance is proportional to the variance.
    const double error = std::max(expected, kMinVariance);
    const double above = before == nullptr ? 0 : (y - expected) / error;
    const double trust = above > kTextureExcess ? std::pow(kTextureExcess / above, 3) : 1;
    const double w = trust * blocks / (error * error);
    fit.sw += w, sx += w * x, sy += w * y, fit.sxx += w * x * x, sxy += w * x * y;
  }
  fit.det = fit.sw * fit.sxx - sx * sx;
  fit.gain = fit.det > 0 ? (fit.sw * sxy - sx * sy) / fit.det : 0;
  fit.floor = fit.det > 0 ? (fit.sxx * sy - sx * sxy) / fit.det : sy / fit.sw;
  if (fit.gain < 0) fit.gain = 0, fit.floor = sy / fit.sw;
  if (fit.floor < 0) fit.floor = 0, fit.gain = sxy / fit.sxx;
  return fit;
}

// The curve: variance in linear light = gain x + floor.
//
// Texture only increases the measured variance. Points that lie above the curve by more than the
// others therefore lose weight in each round; points below the curve keep theirs.
NoiseMeter::Result noise_curve(const std::vector<CurvePoint>& points,
                               const Estimate& correlation_px) {
  // Rounds of reweighting.
  constexpr int kRounds = 30;
  LineFit fit = line_fit(points, nullptr);
  for (int round = 1; round < kRounds; ++round) {
    const LineFit before = fit;
    fit = line_fit(points, &before);
  }
  double chi = 0;
  for (const auto& [x, y, blocks] : points) {
    const double e =
        (y - fit.gain * x - fit.floor) / std::max(fit.gain * x + fit.floor, kMinVariance);
    chi += blocks * std::min(e * e, kMaxSquaredResidual);
  }
  if (fit.gain < kMinVariance) fit.gain = 0;
  if (fit.floor < kMinVariance) fit.floor = 0;
  const double least = fit.gain > 0 || fit.floor > 0 ? kLeastScatter : 0;
  const double scale = std::max(least, chi / std::max<double>(1, double(points.size()) - 2));
  return {{fit.gain, fit.det > 0 ? std::sqrt(scale * fit.sw / fit.det) : fit.gain},
          {fit.floor, fit.det > 0 ? std::sqrt(scale * fit.sxx / fit.det) : fit.floor},
          correlation_px};
}

}  // namespace

void NoiseMeter::add(const image::Picture& frame, const image::Picture& next) {
  const image::ColourCode code(frame.colour);
  const double dark = double(code.ycc_from_rgb({0, 0, 0}).y);
  codes_per_unit_ = double(code.ycc_from_rgb({1, 1, 1}).y) - dark;
  const auto is_clipped = [&](const Statistics& block) {
    return block.least <= dark + kAboveBlack || block.most >= dark + codes_per_unit_ - kBelowWhite;
  };
  const auto is_free = [&](int x, int y) {
    if (own_aircraft_ == nullptr) return true;
    return own_aircraft_->is_free(x, y) && own_aircraft_->is_free(x + kSide - 1, y) &&
           own_aircraft_->is_free(x, y + kSide - 1) &&
           own_aircraft_->is_free(x + kSide - 1, y + kSide - 1);
  };
  for (int y = kSide; y + 2 * kSide <= frame.height; y += 2 * kSide)
    for (int x = kSide; x + 2 * kSide <= frame.width; x += 2 * kSide) {
      if (!is_free(x, y)) continue;
      const Statistics deciding = statistics_of(frame, x, y);
      const Statistics taken = statistics_of(next, x, y);
      if (is_clipped(deciding) || is_clipped(taken)) continue;
      blocks_.push_back({(taken.mean - dark) / codes_per_unit_,
                         taken.variance,
                         taken.covariance,
                         deciding.variance});
    }
}

std::vector<NoiseMeter::Block> NoiseMeter::chosen() const {
  std::array<std::vector<Block>, kBins> bins;
  for (const Block& block : blocks_)
    if (block.luma > 0 && block.luma < 1)
      bins[static_cast<std::size_t>(block.luma * kBins)].push_back(block);
  std::vector<Block> result;
  for (std::vector<Block>& bin : bins) {
    if (bin.size() < kMinBlocks) continue;
    std::ranges::sort(bin, {}, &Block::flatness);
    const auto count =
        std::max(kMinBlocks / 2, static_cast<std::size_t>(kFlatShare * double(bin.size())));
    result.insert(result.end(), bin.begin(), bin.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return result;
}

std::vector<NoisePoint> NoiseMeter::points() const {
  std::array<std::vector<double>, kBins> variances;
  for (const Block& block : chosen())
    variances[static_cast<std::size_t>(block.luma * kBins)].push_back(block.variance);
  std::vector<NoisePoint> points;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const std::vector<double>& v = variances[bin];
    if (v.empty()) continue;
    // The median of a chi-square distribution with kDegrees degrees of freedom lies a little below
    // its mean (Wilson and Hilferty 1931).
    constexpr double kDegrees = kSide * kSide - 3;
    const double down = std::pow(1 - 2 / (9 * kDegrees), 3);
    const double variance = std::max(0.0, median(v) / down - kRounding);
    points.push_back(
        {(double(bin) + 0.5) / kBins, std::sqrt(variance), static_cast<int>(v.size())});
  }
  return points;
}

Measured<NoiseMeter::Result> NoiseMeter::result() const {
  const std::vector<NoisePoint> measured = points();
  if (measured.size() < 2)
    return NotMeasured{"the clip has flat parts of " + std::to_string(measured.size()) +
                       " brightnesses; a noise curve takes two"};
  const composite::Sensor unit{.noise_floor = 1, .tone = tone_};
  std::vector<CurvePoint> curve;
  for (const NoisePoint& p : measured) {
    const double x = double(tone_.linear_from_coded_clamped(static_cast<float>(p.luma)));
    const double codes = double(composite::noise_sigma(
        static_cast<float>(p.luma), static_cast<float>(codes_per_unit_), unit));
    const double y = p.sigma_codes * p.sigma_codes / (codes * codes);
    curve.push_back({x, y, double(std::min(p.blocks, kMaxBlocksOfWeight))});
  }
  return noise_curve(curve, correlation_px());
}

Estimate NoiseMeter::correlation_px() const {
  std::vector<double> correlations;
  for (const Block& block : chosen())
    if (block.variance > 2 * kRounding)
      correlations.push_back(block.covariance / (block.variance - kRounding));
  if (correlations.size() < kMinBlocks) return {0, 1};
  const double middle = median(correlations);
  // The error of the median of Gaussian values is 1.25 times that of their mean.
  const double error = 1.25 * half_spread(correlations) / std::sqrt(double(correlations.size()));
  const double width = width_from_correlation(middle);
  const double off = std::max(std::abs(width_from_correlation(middle + error) - width),
                              std::abs(width_from_correlation(middle - error) - width));
  // If the correlation one error to either side gives the same width, the blocks do not determine
  // the width.
  return {width, off > 0 ? off : std::max(1.0, width)};
}

}  // namespace airtruth::sensor
