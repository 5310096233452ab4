// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "foundation/image/tone_curve.h"

namespace airtruth::optics {

// An unsharp mask on coded luma: the picture plus `amount` times the difference between the picture
// and its Gaussian blur. `radius_px` is the standard deviation of the blur. Picture and blur are
// integrated over whole pixels.
class UnsharpMask {
 public:
  UnsharpMask(double amount, double radius_px);
  // The mask of the same radius with another amount.
  UnsharpMask with_amount(double amount) const;

 private:
  friend class StepModel;
  double amount_;
  // Kernel at the spacing of StepModel's places.
  std::vector<double> kernel_;
};

// The response of a camera to a step of light between two coded levels: a Gaussian spread in linear
// light, then the tone curve, then the unsharp mask. Heights are 0 and 1 far from the step. Places
// are in px from the middle of the coded step.
class StepModel {
 public:
  StepModel(double spread_px,
            const UnsharpMask& mask,
            double low,
            double high,
            const image::ToneCurve& tone);

  // The height at a place and its slope per px.
  std::pair<double, double> at(double place_px) const;

 private:
  friend class UnsharpMask;
  // Half the length of the table of heights, px: places beyond it have the height of its ends.
  static constexpr double kHalf = 9;
  // The number of table entries per pixel.
  static constexpr int kPerPixel = 10;
  // The number of table entries.
  static constexpr std::size_t kCount = 2 * static_cast<std::size_t>(kHalf) * kPerPixel + 1;
  void sharpen(const UnsharpMask& mask);
  double slope(std::size_t i) const;

  std::array<double, kCount> heights_{};
  double middle_ = 0;
};

}  // namespace airtruth::optics
