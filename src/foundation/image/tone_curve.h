// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace airtruth::image {

// The curve by which a camera encodes linear light: the curve of sRGB (IEC 61966-2-1), or the same
// curve with another exponent. The curve is a power of (coded + 0.055) / 1.055; near black it is
// the straight line through 0 that is tangent to this power.
struct ToneCurve {
  // The exponent, 1.2 to 3; 0 is the curve of sRGB itself.
  double gamma = 0;

  // Both functions map 0 to 0 and 1 to 1. They continue by the same power beyond 1.
  double linear_from_coded(double coded) const;
  double coded_from_linear(double linear) const;
  // The same for 0..1. Values outside this range are clamped.
  float linear_from_coded_clamped(float coded) const;
};

}  // namespace airtruth::image
