// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace airtruth::image {

// How a camera codes light: sRGB's curve (IEC 61966-2-1), or the same with another exponent: a
// power of (coded + 0.055) / 1.055, and near black the straight line that touches it.
struct ToneCurve {
  double gamma = 0;  // the exponent, 1.2 to 3; 0: sRGB's own

  // From 0 on, 1 to 1, and beyond 1 by the same power.
  double linear_from_coded(double coded) const;
  double coded_from_linear(double linear) const;
  // 0..1; what lies outside is clamped.
  float linear_from_coded_clamped(float coded) const;
};

}  // namespace airtruth::image
