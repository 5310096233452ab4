// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace airtruth {

// The nearest whole number of pixels, clamped to +-1,000,000, which is far outside any picture. The
// clamp makes the conversion safe for a position or size from a file, which may be any number.
inline int whole_pixels(double px) {
  return static_cast<int>(std::round(std::clamp(px, -1e6, 1e6)));
}

}  // namespace airtruth
