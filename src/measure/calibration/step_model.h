// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "foundation/image/tone_curve.h"

namespace airtruth::calibration {

// An unsharp mask on what is coded: a picture and `amount` times what it differs by from itself
// through a Gaussian, both of whole pixels.
class UnsharpMask {
 public:
  UnsharpMask(double amount, double radius_px);

 private:
  friend class StepModel;
  double amount_;
  std::vector<double> kernel_;  // StepModel's places apart
};

// What becomes of a step of light between two coded levels: a Gaussian's spread in linear light,
// the tone curve, the mask. Heights are 0..1 far from the step, places px from the middle of what
// is coded.
class StepModel {
 public:
  StepModel(double spread_px,
            const UnsharpMask& mask,
            double low,
            double high,
            const image::ToneCurve& tone);

  // The height and its slope by px.
  std::pair<double, double> at(double place_px) const;

 private:
  friend class UnsharpMask;
  static constexpr double kHalf = 9;  // px
  static constexpr int kAPixel = 10;  // places
  static constexpr std::size_t kCount = 2 * static_cast<std::size_t>(kHalf) * kAPixel + 1;
  void sharpen(const UnsharpMask& mask);
  double slope(std::size_t i) const;

  std::array<double, kCount> heights_{};
  double middle_ = 0;
};

}  // namespace airtruth::calibration
