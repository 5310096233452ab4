// SPDX-License-Identifier: Apache-2.0
#include "calibration/optics/step_model.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "foundation/geometry/transform.h"

namespace airtruth::optics {
namespace {

// The second integral of a Gaussian step (an error function).
double bend(double x, double sigma) {
  const double z = x / sigma;
  const double step = 0.5 * (1 + std::erf(z / std::sqrt(2.0)));
  const double bell = std::exp(-0.5 * z * z) / std::sqrt(2 * kPi);
  return 0.5 * ((x * x + sigma * sigma) * step + x * sigma * bell);
}

}  // namespace

UnsharpMask::UnsharpMask(double amount, double radius_px) : amount_(amount) {
  const double sigma = std::hypot(radius_px, std::sqrt(1.0 / 12)) * StepModel::kPerPixel;
  const int reach = static_cast<int>(std::ceil(4.5 * sigma));
  double total = 0;
  for (int j = -reach; j <= reach; ++j) {
    kernel_.push_back(std::exp(-0.5 * (j / sigma) * (j / sigma)));
    total += kernel_.back();
  }
  for (double& weight : kernel_) weight /= total;
}

UnsharpMask UnsharpMask::with_amount(double amount) const {
  UnsharpMask other = *this;
  other.amount_ = amount;
  return other;
}

StepModel::StepModel(double spread_px,
                     const UnsharpMask& mask,
                     double low,
                     double high,
                     const image::ToneCurve& tone) {
  const double dark = tone.linear_from_coded(low);
  const double bright = tone.linear_from_coded(high);
  std::array<double, kCount + 2 * kPerPixel> bends{};
  for (std::size_t i = 0; i < bends.size(); ++i)
    bends[i] = bend(double(i) / kPerPixel - kHalf - 1, spread_px);
  for (std::size_t i = 0; i < kCount; ++i) {
    // The second difference integrates over two boxes of a pixel: the light is that of whole
    // pixels, and so is the spread.
    const double risen = bends[i + 2 * kPerPixel] - 2 * bends[i + kPerPixel] + bends[i];
    heights_[i] = (tone.coded_from_linear(dark + (bright - dark) * risen) - low) / (high - low);
  }
  if (mask.amount_ != 0) sharpen(mask);
  for (const double height : heights_) middle_ += (1 - height) / kPerPixel;
  middle_ -= kHalf + 0.5 / kPerPixel;
}

void StepModel::sharpen(const UnsharpMask& mask) {
  const auto count = static_cast<Eigen::Index>(kCount);
  const auto reach = static_cast<Eigen::Index>(mask.kernel_.size() / 2);
  Eigen::ArrayXd beyond(count + 2 * reach);
  beyond.head(reach) = heights_.front();
  beyond.tail(reach) = heights_.back();
  Eigen::Map<Eigen::ArrayXd> heights(heights_.data(), count);
  beyond.segment(reach, count) = heights;
  // The kernel is symmetric.
  Eigen::ArrayXd soft = mask.kernel_[static_cast<std::size_t>(reach)] * heights;
  for (Eigen::Index j = 0; j < reach; ++j)
    soft += mask.kernel_[static_cast<std::size_t>(j)] *
            (beyond.segment(j, count) + beyond.segment(2 * reach - j, count));
  heights += mask.amount_ * (heights - soft);
}

double StepModel::slope(std::size_t i) const {
  const std::size_t before = i > 0 ? i - 1 : i, after = std::min(i + 1, kCount - 1);
  return (heights_[after] - heights_[before]) * kPerPixel / double(after - before);
}

std::pair<double, double> StepModel::at(double place_px) const {
  const double p =
      std::clamp((place_px + middle_ + kHalf) * kPerPixel, 0.0, double(kCount) - 1.001);
  const auto i = static_cast<std::size_t>(p);
  const double t = p - double(i);
  return {(1 - t) * heights_[i] + t * heights_[i + 1], (1 - t) * slope(i) + t * slope(i + 1)};
}

}  // namespace airtruth::optics
