// SPDX-License-Identifier: Apache-2.0
#include "foundation/image/tone_curve.h"

#include <algorithm>
#include <cmath>

#include "foundation/image/colour.h"

namespace airtruth::image {
namespace {

// The offset of sRGB's power (IEC 61966-2-1), in coded values from 0 to 1.
constexpr double kOffset = 0.055;

struct Toe {
  double gamma, end, slope;  // below the coded value `end`, coded = slope * linear
};

Toe toe_of(double gamma) {
  if (gamma == 0) return {2.4, 0.04045, 12.92};  // IEC 61966-2-1 rounds them so
  const double end = kOffset / (gamma - 1);      // where the line is tangent to the power
  return {gamma, end, end / std::pow((end + kOffset) / (1 + kOffset), gamma)};
}

}  // namespace

double ToneCurve::linear_from_coded(double coded) const {
  const Toe toe = toe_of(gamma);
  return coded <= toe.end ? coded / toe.slope
                          : std::pow((coded + kOffset) / (1 + kOffset), toe.gamma);
}

double ToneCurve::coded_from_linear(double linear) const {
  const Toe toe = toe_of(gamma);
  return toe.slope * linear <= toe.end ? toe.slope * linear
                                       : (1 + kOffset) * std::pow(linear, 1 / toe.gamma) - kOffset;
}

float ToneCurve::linear_from_coded_clamped(float coded) const {
  if (gamma == 0) return linear_from_srgb(coded);
  return static_cast<float>(linear_from_coded(static_cast<double>(std::clamp(coded, 0.0F, 1.0F))));
}

}  // namespace airtruth::image
